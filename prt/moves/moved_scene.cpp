#include "prt/moves/moved_scene.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "mesh/normals.h"
#include "prt/moves/met_boxes.h"
#include "prt/moves/recount.h"
#include "prt/scene/absent_groups.h"
#include "prt/visibility/bias.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::prt {

namespace {

/// A matrix with less volume than this part of that of its columns' lengths is singular.
constexpr double LeastVolume = 1e-6;

/// Where a group goes.
class Motion {
public:
    Motion(const glm::dmat4& matrix, const glm::dvec3& offset)
        : linear_(matrix), offset_(offset), shift_(matrix[3]) {
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row)
                if (!std::isfinite(matrix[column][row]))
                    throw std::invalid_argument("expected a matrix of finite numbers");
        if (glm::dvec4(matrix[0][3], matrix[1][3], matrix[2][3], matrix[3][3]) !=
            glm::dvec4(0.0, 0.0, 0.0, 1.0))
            throw std::invalid_argument("expected a matrix whose last row is 0 0 0 1");
        const double lengths =
            glm::length(linear_[0]) * glm::length(linear_[1]) * glm::length(linear_[2]);
        const double volume = glm::determinant(linear_);
        if (!(std::abs(volume) > LeastVolume * lengths) || !std::isfinite(lengths))
            throw std::invalid_argument(
                "expected a matrix that can be inverted, got a singular one");
        if (volume < 0.0)
            throw std::invalid_argument("expected a matrix that turns and moves, got one that "
                                        "mirrors");
        of_normals_ = glm::transpose(glm::inverse(linear_));
    }

    [[nodiscard]] glm::vec3 place(const glm::vec3& position) const {
        return linear_ * (glm::dvec3(position) + offset_) + shift_ - offset_;
    }
    [[nodiscard]] glm::vec3 way(const glm::vec3& vector) const {
        return linear_ * glm::dvec3(vector);
    }
    [[nodiscard]] glm::vec3 normal(const glm::vec3& normal) const {
        return normal == glm::vec3(0.0f)
                   ? normal
                   : glm::vec3(glm::normalize(of_normals_ * glm::dvec3(normal)));
    }
    /// Turns a tangent, whose length and sign of the bitangent stay.
    [[nodiscard]] glm::vec4 tangent(const glm::vec4& tangent) const {
        const glm::dvec3 before(tangent), after = linear_ * before;
        const double length = glm::length(after);
        return length > 0.0 ? glm::vec4(after * (glm::length(before) / length), tangent.w)
                            : tangent;
    }

private:
    glm::dmat3 linear_, of_normals_{1.0};
    glm::dvec3 offset_, shift_;
};

/// A group by itself: a mesh of its triangles, with their numbers and those of its vertices.
struct GroupMesh {
    mesh::TriangleMesh mesh = {};
    /// Ascending
    std::vector<std::uint32_t> triangles = {}, vertices = {};
};

std::vector<glm::vec3> chosen(const std::vector<glm::vec3>& values,
                              const std::vector<std::uint32_t>& at) {
    std::vector<glm::vec3> result;
    for (std::size_t i = 0; i < at.size() && !values.empty(); ++i)
        result.push_back(values[at[i]]);
    return result;
}

/// `name`: of the group. `all`: the mesh's triangles, or what they are with all groups there.
GroupMesh group_of(const mesh::TriangleMesh& mesh, const std::string& name,
                   const std::vector<mesh::Triangle>& all) {
    const auto group =
        static_cast<std::uint32_t>(std::ranges::find(mesh.groups, name) - mesh.groups.begin());
    GroupMesh result{.triangles = triangles_of(mesh, group)};
    constexpr std::uint32_t None = ~std::uint32_t{0};
    std::vector<std::uint32_t> index(mesh.num_vertices(), None);
    for (const std::uint32_t i : result.triangles)
        for (const std::uint32_t vertex : all[i])
            index[vertex] = 0;
    for (std::uint32_t vertex = 0; vertex < index.size(); ++vertex)
        if (index[vertex] != None) {
            index[vertex] = static_cast<std::uint32_t>(result.vertices.size());
            result.vertices.push_back(vertex);
        }
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i)
        for (const std::uint32_t vertex : all[i])
            if (mesh.triangle_groups[i] != group && index[vertex] != None)
                throw std::invalid_argument(fmt::format(
                    "expected a group with vertices of its own, got {}, which shares some with {}",
                    name, mesh.groups[mesh.triangle_groups[i]]));
    for (const std::uint32_t i : result.triangles) {
        const auto [a, b, c] = all[i];
        result.mesh.triangles.push_back({index[a], index[b], index[c]});
    }
    result.mesh.positions = chosen(mesh.positions, result.vertices);
    result.mesh.normals = chosen(mesh.normals, result.vertices);
    result.mesh.lifts = chosen(mesh.lifts, result.vertices);
    return result;
}

template<typename Value, typename Move>
void move_all(std::vector<Value>& values, const Move& move) {
    for (Value& value : values)
        value = move(value);
}

/// Exchanges some values.
template<typename Value>
void exchange(std::vector<Value>& all, const std::vector<std::uint32_t>& at,
              std::vector<Value>& some) {
    for (std::size_t i = 0; i < some.size(); ++i)
        std::swap(all[at[i]], some[i]);
}

/// Gives the change the receivers that differ, at their new places. `after` is the group there.
/// `motion` takes receivers that are no vertices there.
void move_receivers(const Scene& scene, const GroupMesh& before, const mesh::TriangleMesh& after,
                    const Motion* motion, SceneChange& change) {
    const Receivers& receivers = scene.receivers;
    const auto add = [&](std::uint32_t i, const glm::vec3& position, const glm::vec3& normal) {
        if (position == receivers.positions[i] && normal == receivers.normals[i])
            return;
        change.receivers.push_back(i);
        change.receiver_positions.push_back(position);
        change.receiver_normals.push_back(normal);
        change.difference.receivers[i] = true;
    };
    change.difference.receivers.resize(receivers.size());
    if (on_vertices(scene.layout)) {
        Receivers next = vertex_receivers(after, *change.rim_step);
        for (std::size_t i = 0; i < before.vertices.size() && !receivers.surfaces.empty(); ++i)
            next.surfaces.push_back(receivers.surfaces[before.vertices[i]]);
        leave_unlit_out(next);
        for (std::size_t i = 0; i < before.vertices.size(); ++i)
            add(before.vertices[i], next.positions[i], next.normals[i]);
    } else {
        std::vector<bool> is_of_group(scene.mesh.num_triangles());
        for (const std::uint32_t triangle : before.triangles)
            is_of_group[triangle] = true;
        for (std::size_t i = receivers.num_points(); i < receivers.size(); ++i)
            if (is_of_group[receivers.points[i].triangle])
                add(static_cast<std::uint32_t>(i), motion->place(receivers.positions[i]),
                    motion->normal(receivers.normals[i]));
    }
    set_places(scene, change);
}

/// Returns a group that may change.
GroupMesh changing_group(const Scene& scene, std::uint32_t group,
                         const std::vector<mesh::Triangle>& all) {
    if (!scene.receivers.to_eye.empty())
        throw std::invalid_argument(
            on_vertices(scene.layout)
                ? "expected highlights that follow the eye where things move, got those of a fixed "
                  "view"
                : "expected vertices or texels where things move, got pixels: they see other "
                  "things "
                  "then");
    if (scene.mesh.triangle_groups.empty() ||
        (scene.blockers && scene.blockers->triangle_groups.empty()))
        throw std::invalid_argument(
            "expected a scene that was precomputed with --movable, got one without groups");
    GroupMesh result = group_of(scene.mesh, scene.mesh.groups[group], all);
    const std::size_t num_floor =
        std::size_t{scene.settings.floor_vertices} * scene.settings.floor_vertices +
        scene.settings.floor_added;
    if (!result.vertices.empty() && result.vertices.back() + num_floor >= scene.mesh.num_vertices())
        throw std::invalid_argument("expected a group of the mesh, got its added floor");
    return result;
}

void require_there(const Scene& scene, std::uint32_t group) {
    if (absent(scene, group) != nullptr)
        throw std::invalid_argument(
            fmt::format("expected a group that is there, got {}, which was taken away",
                        scene.mesh.groups[group]));
}

/// Adds boxes around a group as it stands before a change, or after it.
void add_boxes(SceneDifference& difference, const mesh::TriangleMesh& group, std::size_t side) {
    for (const mesh::Bounds& box : boxes_around(group)) {
        difference.boxes.push_back(box);
        include(difference.around[side], box);
    }
}

void require_places(const std::vector<glm::vec3>& positions, float bias) {
    for (const glm::vec3& position : positions)
        for (int axis = 0; axis < 3; ++axis)
            if (!(std::abs(position[axis]) + 2.0f * bias < LargestCoordinate))
                throw std::invalid_argument(
                    fmt::format("expected coordinates within {} after the move, got {}",
                                LargestCoordinate - 2.0f * bias, position[axis]));
}

} // namespace

float rim_step_of(const Scene& scene) {
    return scene.settings.rim_step ? *scene.settings.rim_step : automatic_bias(scene.mesh);
}

void set_places(const Scene& scene, SceneChange& change) {
    change.places.clear();
    change.normals_by_place.clear();
    const std::vector<std::uint32_t>& order = scene.transfer.order;
    for (std::uint32_t place = 0; place < order.size(); ++place)
        if (change.difference.receivers[order[place]]) {
            const auto found = std::ranges::lower_bound(change.receivers, order[place]);
            change.places.push_back(place);
            change.normals_by_place.push_back(
                change
                    .receiver_normals[static_cast<std::size_t>(found - change.receivers.begin())]);
        }
}

void exchange(Scene& scene, SceneChange& change) {
    exchange(scene.mesh.positions, change.vertices, change.positions);
    exchange(scene.mesh.normals, change.vertices, change.normals);
    if (!change.lifts.empty())
        scene.mesh.lifts.resize(scene.mesh.num_vertices(), glm::vec3(0.0f));
    exchange(scene.mesh.lifts, change.lifted, change.lifts);
    exchange(scene.free_lifts, change.lifted, change.free_lifts);
    if (std::ranges::all_of(scene.mesh.lifts,
                            [](const glm::vec3& lift) { return lift == glm::vec3(0.0f); }))
        scene.mesh.lifts.clear();
    exchange(scene.mesh.corner_tangents, change.triangles, change.corner_tangents);
    exchange(scene.mesh.triangles, change.triangles, change.corners);
    if (scene.blockers) {
        exchange(scene.blockers->positions, change.blocker_vertices, change.blocker_positions);
        exchange(scene.blockers->triangles, change.blocker_triangles, change.blocker_corners);
    }
    if (change.absent)
        scene.absent.swap(*change.absent);
    exchange(scene.receivers.positions, change.receivers, change.receiver_positions);
    exchange(scene.receivers.normals, change.receivers, change.receiver_normals);
    exchange(scene.transfer.normals, change.places, change.normals_by_place);
    exchange(scene.transfer.counts, change.counts);
    if (change.bounces_patch)
        exchange(*scene.bounces, *change.bounces_patch);
    else if (change.bounces)
        scene.bounces.swap(change.bounces);
    scene.settings.rim_step.swap(change.rim_step);
}

std::vector<std::uint64_t> changed_blocks(const VisibleCounts& counts, const SceneChange& change) {
    std::vector<std::uint64_t> result(counts.num_tiles());
    const auto mark = [&](std::size_t block) {
        result[block / VisibleCounts::TileBlocks] |= std::uint64_t{1}
                                                     << block % VisibleCounts::TileBlocks;
    };
    for (const CountsPatch::Word& word : change.counts.words)
        mark(counts.block_of(word.word));
    for (const std::uint32_t place : change.places)
        mark(place / BlockSize);
    return result;
}

SceneChange outline(const SceneChange& first, const SceneChange& second) {
    SceneChange result;
    for (const SceneChange* change : {&first, &second}) {
        for (const CountsPatch::Word& word : change->counts.words)
            result.counts.words.push_back({.word = word.word, .clusters = word.clusters});
        result.places.insert(result.places.end(), change->places.begin(), change->places.end());
        std::vector<mesh::Bounds>& boxes = result.difference.boxes;
        boxes.insert(boxes.end(), change->difference.boxes.begin(), change->difference.boxes.end());
    }
    return result;
}

namespace {

/// A group's mesh and what blocks light of it, before and after.
struct Taken {
    GroupMesh before = {}, blockers_before = {};
    mesh::TriangleMesh after = {};
    std::vector<glm::vec3> blockers_after = {};
};

/// Returns a group that is there.
Taken taken(const Scene& scene, std::uint32_t group) {
    Taken result{.before = changing_group(scene, group, scene.mesh.triangles)};
    require_there(scene, group);
    result.after = result.before.mesh;
    if (scene.blockers)
        result.blockers_before =
            group_of(*scene.blockers, scene.mesh.groups[group], scene.blockers->triangles);
    result.blockers_after = result.blockers_before.mesh.positions;
    return result;
}

/// Returns the change that takes a group there. `turn` turns a tangent of a vertex of the group.
template<typename Turn>
SceneChange change_of(const Scene& scene, std::uint32_t group, Taken taken, const Motion* motion,
                      const Turn& turn) {
    auto& [before, blockers, after, blockers_after] = taken;
    require_places(after.positions, scene.settings.bias);
    SceneChange change;
    change.groups = {group};
    change.rim_step = rim_step_of(scene);
    change.difference.around = {no_box(), no_box()};
    if (scene.blockers) {
        require_places(blockers_after, scene.settings.bias);
        add_boxes(change.difference, blockers.mesh, 0);
        change.blocker_vertices = std::move(blockers.vertices);
        blockers.mesh.positions = blockers_after;
        add_boxes(change.difference, blockers.mesh, 1);
        change.blocker_positions = std::move(blockers_after);
    }
    add_boxes(change.difference, before.mesh, 0);
    add_boxes(change.difference, after, 1);
    for (std::size_t i = 0; i < before.triangles.size() && !scene.mesh.corner_tangents.empty();
         ++i) {
        change.triangles.push_back(before.triangles[i]);
        change.corner_tangents.push_back(scene.mesh.corner_tangents[before.triangles[i]]);
        for (std::size_t k = 0; k < 3; ++k)
            change.corner_tangents.back()[k] =
                turn(change.corner_tangents.back()[k], before.mesh.triangles[i][k]);
    }
    move_receivers(scene, before, after, motion, change);
    change.lifts = std::move(after.lifts);
    change.free_lifts = chosen(scene.free_lifts, before.vertices);
    for (std::uint32_t i = 0; i < change.free_lifts.size(); ++i)
        change.free_lifts[i] = turn(change.free_lifts[i], i);
    if (!change.lifts.empty() || !change.free_lifts.empty())
        change.lifted = before.vertices;
    change.vertices = std::move(before.vertices);
    change.positions = std::move(after.positions);
    change.normals = std::move(after.normals);
    return change;
}

/// How a group turns at each of its vertices where it takes another pose: as its smooth normals do.
class Turns {
public:
    Turns(const mesh::TriangleMesh& before, const mesh::TriangleMesh& after)
        : from_(mesh::smooth_normals(before)), to_(mesh::smooth_normals(after)) {}

    [[nodiscard]] glm::vec3 operator()(const glm::vec3& vector, std::size_t vertex) const {
        const glm::dvec3 from(from_[vertex]), to(to_[vertex]), way(vector);
        const double cosine = glm::dot(from, to);
        if (from == glm::dvec3(0.0) || to == glm::dvec3(0.0) || from == to)
            return vector;
        if (!(cosine > -1.0 + 1e-9))
            return -vector;
        const glm::dvec3 axis = glm::cross(from, to);
        return way * cosine + glm::cross(axis, way) + axis * (glm::dot(axis, way) / (1.0 + cosine));
    }
    [[nodiscard]] glm::vec4 operator()(const glm::vec4& tangent, std::size_t vertex) const {
        return {(*this)(glm::vec3(tangent), vertex), tangent.w};
    }

private:
    std::vector<glm::vec3> from_, to_;
};

} // namespace

SceneChange moved(const Scene& scene, std::uint32_t group, const glm::dmat4& matrix) {
    const Motion motion(matrix, scene.mesh.offset);
    Taken own = taken(scene, group);
    const auto place = [&](const glm::vec3& position) {
        return motion.place(position);
    };
    move_all(own.after.positions, place);
    move_all(own.blockers_after, place);
    move_all(own.after.normals, [&](const glm::vec3& normal) { return motion.normal(normal); });
    move_all(own.after.lifts, [&](const glm::vec3& way) { return motion.way(way); });
    struct {
        const Motion& motion;
        glm::vec3 operator()(const glm::vec3& way, std::uint32_t) const { return motion.way(way); }
        glm::vec4 operator()(const glm::vec4& tangent, std::uint32_t) const {
            return motion.tangent(tangent);
        }
    } const turn{motion};
    return change_of(scene, group, std::move(own), &motion, turn);
}

SceneChange posed(const Scene& scene, std::uint32_t group, std::span<const glm::dvec3> vertices,
                  std::span<const glm::vec3> normals) {
    if (!on_vertices(scene.layout))
        throw std::invalid_argument(
            "expected vertices as receivers where a group takes another pose, got others");
    Taken own = taken(scene, group);
    const std::string& name = scene.mesh.groups[group];
    if (scene.blockers && own.blockers_after != own.before.mesh.positions)
        throw std::invalid_argument(fmt::format(
            "expected a group that is lit as the mesh has it where it takes another pose, got {}, "
            "which was refined: precompute --refine off leaves it as it is",
            name));
    if (vertices.size() != own.before.vertices.size())
        throw std::invalid_argument(fmt::format("expected the {} vertices of {}, got {}",
                                                own.before.vertices.size(), name, vertices.size()));
    if (!normals.empty() && normals.size() != vertices.size())
        throw std::invalid_argument(fmt::format("expected normals of {} vertices, or none, got {}",
                                                vertices.size(), normals.size()));
    for (std::size_t i = 0; i < vertices.size(); ++i)
        own.after.positions[i] = vertices[i] - scene.mesh.offset;
    if (scene.blockers)
        own.blockers_after = own.after.positions;
    const Turns turns(own.before.mesh, own.after);
    for (std::size_t i = 0; i < own.after.normals.size(); ++i)
        own.after.normals[i] = normals.empty() ? turns(own.after.normals[i], i) : normals[i];
    for (std::size_t i = 0; i < own.after.lifts.size(); ++i)
        own.after.lifts[i] = turns(own.after.lifts[i], i);
    return change_of(scene, group, std::move(own), nullptr, turns);
}

namespace {

template<typename Value>
void append(std::vector<Value>& values, const std::vector<Value>& more) {
    values.insert(values.end(), more.begin(), more.end());
}

/// Sorts numbers, and the lists that go with them and are not empty.
template<typename... Values>
void sort_by(std::vector<std::uint32_t>& numbers, std::vector<Values>&... lists) {
    std::vector<std::size_t> order(numbers.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t i) { return numbers[i]; });
    const auto sort = [&](auto& values) {
        auto sorted = values;
        for (std::size_t i = 0; i < values.size(); ++i)
            sorted[i] = values[order[i]];
        values = std::move(sorted);
    };
    (sort(lists), ...);
    sort(numbers);
}

/// Lets every two neighbours among boxes share one until there are so few that rays find them soon.
void thin_out(std::vector<mesh::Bounds>& boxes) {
    constexpr std::size_t MostBoxes = 256; // of eight groups each has all its own
    while (boxes.size() > MostBoxes) {
        for (std::size_t i = 0; i + 1 < boxes.size(); i += 2)
            include(boxes[i], boxes[i + 1]);
        for (std::size_t i = 0; 2 * i < boxes.size(); ++i)
            boxes[i] = boxes[2 * i];
        boxes.resize((boxes.size() + 1) / 2);
    }
}

} // namespace

SceneChange joined(const Scene& scene, std::vector<SceneChange> changes) {
    SceneChange all = std::move(changes.at(0));
    for (std::size_t i = 0; i < changes.size(); ++i) {
        const SceneChange& own = i == 0 ? all : changes[i];
        if (own.absent)
            throw std::invalid_argument(fmt::format(
                "expected groups that move together, got {}, which is taken away or brought back",
                scene.mesh.groups[own.groups.front()]));
        if (i == 0)
            continue;
        if (std::ranges::count(all.groups, own.groups.front()) != 0)
            throw std::invalid_argument(fmt::format("expected each group once, got {} twice",
                                                    scene.mesh.groups[own.groups.front()]));
        append(all.groups, own.groups);
        append(all.vertices, own.vertices);
        append(all.positions, own.positions);
        append(all.normals, own.normals);
        append(all.lifted, own.lifted);
        append(all.lifts, own.lifts);
        append(all.free_lifts, own.free_lifts);
        append(all.triangles, own.triangles);
        append(all.corner_tangents, own.corner_tangents);
        append(all.blocker_vertices, own.blocker_vertices);
        append(all.blocker_positions, own.blocker_positions);
        append(all.receivers, own.receivers);
        append(all.receiver_positions, own.receiver_positions);
        append(all.receiver_normals, own.receiver_normals);
        append(all.difference.boxes, own.difference.boxes);
        for (std::size_t side = 0; side < all.difference.around.size(); ++side)
            include(all.difference.around[side], own.difference.around[side]);
        for (const std::uint32_t receiver : own.receivers)
            all.difference.receivers[receiver] = true;
    }
    if (changes.size() == 1)
        return all;
    sort_by(all.vertices, all.positions, all.normals);
    sort_by(all.lifted, all.lifts, all.free_lifts);
    sort_by(all.receivers, all.receiver_positions, all.receiver_normals);
    thin_out(all.difference.boxes);
    set_places(scene, all);
    return all;
}

namespace {

/// What triangles become.
std::vector<mesh::Triangle> all_away(const mesh::TriangleMesh& mesh,
                                     const std::vector<std::uint32_t>& triangles) {
    std::vector<mesh::Triangle> result;
    for (const std::uint32_t i : triangles)
        result.push_back(away(mesh.triangles[i]));
    return result;
}

/// A change that takes a group away, or brings it back. `all` triangles of the mesh, and of what
/// blocks, as they are with all groups there.
SceneChange without_or_with(const Scene& scene, std::uint32_t group,
                            const std::vector<mesh::Triangle>& all,
                            const std::vector<mesh::Triangle>& all_blockers) {
    const AbsentGroup* own = absent(scene, group);
    const std::size_t side = own != nullptr ? 1 : 0;
    GroupMesh mesh = changing_group(scene, group, all);
    SceneChange change;
    change.groups = {group};
    change.rim_step = rim_step_of(scene);
    change.absent = scene.absent;
    change.difference.around = {no_box(), no_box()};
    change.difference.receivers.resize(scene.receivers.size());
    add_boxes(change.difference, mesh.mesh, side);
    if (scene.blockers) {
        const GroupMesh blockers =
            group_of(*scene.blockers, scene.mesh.groups[group], all_blockers);
        add_boxes(change.difference, blockers.mesh, side);
        change.blocker_triangles = blockers.triangles;
        change.blocker_corners =
            own != nullptr ? own->blockers : all_away(*scene.blockers, blockers.triangles);
    }
    change.triangles = std::move(mesh.triangles);
    change.corners = own != nullptr ? own->triangles : all_away(scene.mesh, change.triangles);
    return change;
}

} // namespace

SceneChange taken_away(const Scene& scene, std::uint32_t group) {
    require_there(scene, group);
    SceneChange change =
        without_or_with(scene, group, scene.mesh.triangles, scene.blocking_mesh().triangles);
    AbsentGroup own{.group = group};
    for (const std::uint32_t i : change.triangles)
        own.triangles.push_back(scene.mesh.triangles[i]);
    for (const std::uint32_t i : change.blocker_triangles)
        own.blockers.push_back(scene.blockers->triangles[i]);
    change.absent->push_back(std::move(own));
    return change;
}

SceneChange brought_back(const Scene& scene, std::uint32_t group) {
    if (absent(scene, group) == nullptr)
        throw std::invalid_argument(
            fmt::format("expected a group that was taken away, got {}, which is there",
                        scene.mesh.groups[group]));
    const std::vector<mesh::Triangle> all = whole_mesh(scene);
    SceneChange change =
        without_or_with(scene, group, all, scene.blockers ? whole_blockers(scene) : all);
    std::erase_if(*change.absent, [&](const AbsentGroup& own) { return own.group == group; });
    return change;
}

} // namespace relumine::prt
