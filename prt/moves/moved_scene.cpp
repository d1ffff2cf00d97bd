#include "prt/moves/moved_scene.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

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

/// The triangles of a group, and which vertices are theirs.
struct GroupParts {
    std::vector<mesh::Triangle> triangles;
    /// [num_vertices]
    std::vector<bool> vertices;
};

/// `name`: of the group.
GroupParts parts_of(const mesh::TriangleMesh& mesh, const std::string& name) {
    GroupParts parts;
    parts.vertices.resize(mesh.num_vertices());
    const auto is_of_group = [&](std::size_t triangle) {
        return mesh.groups[mesh.triangle_groups[triangle]] == name;
    };
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
        if (!is_of_group(i))
            continue;
        parts.triangles.push_back(mesh.triangles[i]);
        for (const std::uint32_t vertex : mesh.triangles[i])
            parts.vertices[vertex] = true;
    }
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i)
        for (const std::uint32_t vertex : mesh.triangles[i])
            if (parts.vertices[vertex] && !is_of_group(i))
                throw std::invalid_argument(fmt::format(
                    "expected a group with vertices of its own, got {}, which shares some with {}",
                    name, mesh.groups[mesh.triangle_groups[i]]));
    return parts;
}

/// Moves the values of some vertices.
template<typename Move>
void move_some(std::vector<glm::vec3>& values, const std::vector<bool>& which, const Move& move) {
    for (std::size_t i = 0; i < values.size(); ++i)
        if (which[i])
            values[i] = move(values[i]);
}

/// Gives the change the receivers at their new places. `after` is the mesh there.
void move_receivers(const Scene& scene, const mesh::TriangleMesh& after,
                    const std::vector<bool>& vertices, const Motion& motion, SceneChange& change) {
    const Receivers& receivers = scene.receivers;
    if (on_vertices(scene.layout)) {
        Receivers next = vertex_receivers(after, *change.rim_step);
        next.surfaces = receivers.surfaces;
        leave_unlit_out(next);
        change.receiver_positions = std::move(next.positions);
        change.receiver_normals = std::move(next.normals);
        return;
    }
    change.receiver_positions = receivers.positions;
    change.receiver_normals = receivers.normals;
    for (std::size_t i = receivers.num_points(); i < receivers.size(); ++i)
        if (vertices[scene.mesh.triangles[receivers.points[i].triangle][0]]) {
            change.receiver_positions[i] = motion.place(receivers.positions[i]);
            change.receiver_normals[i] = motion.normal(receivers.normals[i]);
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

void exchange(Scene& scene, SceneChange& change) {
    scene.mesh.positions.swap(change.positions);
    scene.mesh.normals.swap(change.normals);
    scene.mesh.lifts.swap(change.lifts);
    scene.mesh.corner_tangents.swap(change.corner_tangents);
    if (scene.blockers)
        scene.blockers->positions.swap(change.blocker_positions);
    scene.receivers.positions.swap(change.receiver_positions);
    scene.receivers.normals.swap(change.receiver_normals);
    scene.transfer.normals.swap(change.normals_by_place);
    exchange(scene.transfer.counts, change.counts);
    scene.bounces.swap(change.bounces);
    scene.settings.rim_step.swap(change.rim_step);
}

SceneChange moved(const Scene& scene, std::uint32_t group, const glm::dmat4& matrix,
                  SceneDifference& difference) {
    const Motion motion(matrix, scene.mesh.offset);
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
    const std::string& name = scene.mesh.groups[group];
    const GroupParts parts = parts_of(scene.mesh, name);
    const std::size_t num_floor =
        std::size_t{scene.settings.floor_vertices} * scene.settings.floor_vertices +
        scene.settings.floor_added;
    if (std::find(parts.vertices.end() - static_cast<std::ptrdiff_t>(num_floor),
                  parts.vertices.end(), true) != parts.vertices.end())
        throw std::invalid_argument("expected a group of the mesh, got its added floor");

    mesh::TriangleMesh after = scene.mesh;
    const auto place = [&](const glm::vec3& position) {
        return motion.place(position);
    };
    move_some(after.positions, parts.vertices, place);
    move_some(after.normals, parts.vertices, [&](const auto& n) { return motion.normal(n); });
    move_some(after.lifts, parts.vertices, [&](const auto& way) { return motion.way(way); });
    for (std::size_t i = 0; i < after.corner_tangents.size(); ++i)
        if (parts.vertices[after.triangles[i][0]])
            for (glm::vec4& tangent : after.corner_tangents[i])
                tangent = motion.tangent(tangent);
    require_places(after.positions, scene.settings.bias);

    SceneChange change;
    change.rim_step = scene.settings.rim_step.value_or(automatic_bias(scene.mesh));
    const auto add_boxes = [&](const mesh::TriangleMesh& mesh,
                               const std::vector<mesh::Triangle>& triangles) {
        std::ranges::move(boxes_around(mesh, triangles), std::back_inserter(difference.boxes));
    };
    if (scene.blockers) {
        const GroupParts of_blockers = parts_of(*scene.blockers, name);
        mesh::TriangleMesh next;
        next.positions = scene.blockers->positions;
        move_some(next.positions, of_blockers.vertices, place);
        require_places(next.positions, scene.settings.bias);
        add_boxes(*scene.blockers, of_blockers.triangles);
        add_boxes(next, of_blockers.triangles);
        change.blocker_positions = std::move(next.positions);
    }
    add_boxes(scene.mesh, parts.triangles);
    add_boxes(after, parts.triangles);
    move_receivers(scene, after, parts.vertices, motion, change);
    difference.receivers.resize(scene.receivers.size());
    for (std::size_t i = 0; i < scene.receivers.size(); ++i)
        difference.receivers[i] = change.receiver_positions[i] != scene.receivers.positions[i] ||
                                  change.receiver_normals[i] != scene.receivers.normals[i];
    for (const std::uint32_t receiver : scene.transfer.order)
        change.normals_by_place.push_back(change.receiver_normals[receiver]);
    change.positions = std::move(after.positions);
    change.normals = std::move(after.normals);
    change.lifts = std::move(after.lifts);
    change.corner_tangents = std::move(after.corner_tangents);
    return change;
}

} // namespace relumine::prt
