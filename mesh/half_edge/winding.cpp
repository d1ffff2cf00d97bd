#include "mesh/half_edge/winding.h"

#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "mesh/edge_uses.h"

namespace relumine::mesh {

namespace {

/// A patch whose area vectors sum to less than this part of its area is closed or nearly so: the
/// holes of a scanned bunny are 2 %, a box without its lid has 20 %.
constexpr double NearlyClosed = 0.05;

/// Beside the patch of a triangle: whether it is turned against the patch's first triangle.
struct Joined {
    std::uint32_t triangle;
    bool is_turned;
};

/// The triangles next to each triangle, over edges that two triangles share.
class Neighbours {
public:
    Neighbours(std::span<const EdgeUse> uses, std::size_t num_triangles)
        : begin_(num_triangles + 1) {
        const auto for_pairs = [&](const auto& action) {
            for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
                if (edge.size() != 2 || edge[0].triangle() == edge[1].triangle())
                    return;
                const bool is_turned = edge[0].ascends == edge[1].ascends;
                action(edge[0].triangle(), Joined{edge[1].triangle(), is_turned});
                action(edge[1].triangle(), Joined{edge[0].triangle(), is_turned});
            });
        };
        for_pairs([&](std::uint32_t from, const Joined&) { ++begin_[from + 1]; });
        for (std::size_t i = 1; i < begin_.size(); ++i)
            begin_[i] += begin_[i - 1];
        joined_.resize(begin_.back());
        std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
        for_pairs([&](std::uint32_t from, const Joined& to) { joined_[next[from]++] = to; });
    }
    [[nodiscard]] std::span<const Joined> of(std::uint32_t triangle) const {
        return std::span(joined_).subspan(begin_[triangle],
                                          begin_[triangle + 1] - begin_[triangle]);
    }

private:
    std::vector<std::size_t> begin_;
    std::vector<Joined> joined_;
};

/// Triangles that one winding decides.
struct Patch {
    std::vector<std::uint32_t> triangles;
    bool is_closed = false;
    /// Times six, as wound like the first triangle.
    double volume = 0.0;
    double area = 0.0, turned_area = 0.0;
    Bounds box;
    /// Closed patches around it.
    std::vector<const Patch*> holders = {};
    /// Whether it has to face outwards. Empty: it may do either.
    std::optional<bool> outwards = {};

    /// Whether most of it faces outwards, as it is wound in the file.
    [[nodiscard]] bool faces_outwards() const {
        return (volume > 0.0) != (2.0 * turned_area > area);
    }
};

bool contains(const Bounds& outer, const Bounds& inner) {
    return glm::all(glm::lessThanEqual(outer.min, inner.min)) &&
           glm::all(glm::greaterThanEqual(outer.max, inner.max));
}

/// Returns how often a ray from a point crosses a patch. The direction is odd, so that it hardly
/// meets an edge.
std::size_t num_crossings(const TriangleMesh& mesh, const Patch& patch, const glm::dvec3& origin) {
    const glm::dvec3 direction = glm::normalize(glm::dvec3(0.43711, 0.71279, 0.54853));
    std::size_t count = 0;
    for (const std::uint32_t i : patch.triangles) {
        std::array<glm::dvec3, 3> to{};
        for (std::size_t k = 0; k < 3; ++k)
            to[k] = glm::dvec3(mesh.positions[mesh.triangles[i][k]]) - origin;
        std::array<double, 3> side{};
        for (std::size_t k = 0; k < 3; ++k)
            side[k] = glm::dot(direction, glm::cross(to[k], to[(k + 1) % 3]));
        const bool is_hit = (side[0] > 0.0 && side[1] > 0.0 && side[2] > 0.0) ||
                            (side[0] < 0.0 && side[1] < 0.0 && side[2] < 0.0);
        if (!is_hit)
            continue;
        const glm::dvec3 normal = glm::cross(to[1] - to[0], to[2] - to[0]);
        const double distance = glm::dot(to[0], normal) / glm::dot(direction, normal);
        count += distance > 0.0 ? 1 : 0;
    }
    return count;
}

/// Finds the patches, and for each triangle whether it is turned against its patch's first.
std::vector<Patch> patches_of(const TriangleMesh& mesh, std::span<const EdgeUse> uses,
                              std::vector<bool>& is_turned) {
    const Neighbours neighbours(uses, mesh.num_triangles());
    std::vector<Patch> patches;
    std::vector<bool> is_seen(mesh.num_triangles());
    for (std::uint32_t seed = 0; seed < mesh.num_triangles(); ++seed) {
        if (is_seen[seed])
            continue;
        Patch& patch = patches.emplace_back();
        patch.triangles.push_back(seed);
        is_seen[seed] = true;
        for (std::size_t i = 0; i < patch.triangles.size(); ++i)
            for (const Joined& next : neighbours.of(patch.triangles[i]))
                if (!is_seen[next.triangle]) {
                    is_seen[next.triangle] = true;
                    is_turned[next.triangle] = is_turned[patch.triangles[i]] != next.is_turned;
                    patch.triangles.push_back(next.triangle);
                }
    }
    return patches;
}

void measure(const TriangleMesh& mesh, const std::vector<bool>& is_turned, Patch& patch) {
    const glm::vec3 first = mesh.positions[mesh.triangles[patch.triangles.front()][0]];
    patch.box = {first, first};
    glm::dvec3 centre(0.0), vector_area(0.0);
    for (const std::uint32_t i : patch.triangles) {
        const glm::dvec3 normal = area_normal(mesh.positions, mesh.triangles[i]);
        const double area = glm::length(normal);
        patch.area += area;
        patch.turned_area += is_turned[i] ? area : 0.0;
        vector_area += is_turned[i] ? -normal : normal;
        for (const std::uint32_t vertex : mesh.triangles[i]) {
            centre += area / 3.0 * glm::dvec3(mesh.positions[vertex]);
            patch.box.min = glm::min(patch.box.min, mesh.positions[vertex]);
            patch.box.max = glm::max(patch.box.max, mesh.positions[vertex]);
        }
    }
    if (!(patch.area > 0.0))
        return;
    centre /= patch.area;
    for (const std::uint32_t i : patch.triangles) {
        const glm::dvec3 normal = area_normal(mesh.positions, mesh.triangles[i]);
        const glm::dvec3 to = glm::dvec3(mesh.positions[mesh.triangles[i][0]]) - centre;
        patch.volume += (is_turned[i] ? -1.0 : 1.0) * glm::dot(to, normal);
    }
    // A sheet encloses nothing, though its area vectors may cancel.
    constexpr double LeastVolume = 1e-4;
    patch.is_closed = glm::length(vector_area) < NearlyClosed * patch.area &&
                      std::abs(patch.volume) > LeastVolume * std::pow(patch.area, 1.5);
}

/// Decides which way closed patches have to face.
void set_sides(const TriangleMesh& mesh, std::vector<Patch>& patches) {
    for (Patch& patch : patches) {
        if (!patch.is_closed)
            continue;
        const glm::dvec3 point(mesh.positions[mesh.triangles[patch.triangles.front()][0]]);
        for (const Patch& other : patches)
            if (&other != &patch && other.is_closed && contains(other.box, patch.box) &&
                num_crossings(mesh, other, point) % 2 == 1)
                patch.holders.push_back(&other);
    }
    // Closed patches in no other, or in one, by the outermost: the area that faces outwards within
    // it, less that which faces inwards.
    std::map<const Patch*, double> outward_inside;
    for (const Patch& patch : patches)
        if (patch.holders.size() == 1)
            outward_inside[patch.holders.front()] +=
                patch.faces_outwards() ? patch.area : -patch.area;
    const auto is_room = [&](const Patch& patch) {
        const auto found = outward_inside.find(&patch);
        return !patch.faces_outwards() && found != outward_inside.end() && found->second > 0.0;
    };
    for (Patch& patch : patches)
        if (patch.is_closed && patch.holders.empty())
            patch.outwards = !is_room(patch);
        else if (patch.holders.size() == 1 && is_room(*patch.holders.front()))
            patch.outwards = true;
}

/// Finds the patches, and marks the triangles that are wound the wrong way round.
std::vector<Patch> settled_patches(const TriangleMesh& mesh, std::span<const EdgeUse> uses,
                                   std::vector<bool>& is_wrong) {
    is_wrong.assign(mesh.num_triangles(), false);
    std::vector<Patch> patches = patches_of(mesh, uses, is_wrong);
    for (Patch& patch : patches)
        measure(mesh, is_wrong, patch);
    set_sides(mesh, patches);
    for (const Patch& patch : patches) {
        const bool turns = patch.outwards ? (patch.volume < 0.0) == *patch.outwards
                                          : 2.0 * patch.turned_area > patch.area;
        if (turns)
            for (const std::uint32_t i : patch.triangles)
                is_wrong[i] = !is_wrong[i];
    }
    return patches;
}

/// The triangles of vertices that are one where their positions are.
std::vector<Triangle> welded_triangles(const TriangleMesh& mesh) {
    return renamed(mesh.triangles, first_at_place(mesh.positions));
}

/// Marks the patches that have a vertex of another one.
std::vector<bool> patches_that_share(const TriangleMesh& mesh, std::span<const Patch> patches) {
    constexpr std::size_t None = ~std::size_t{0};
    std::vector<std::size_t> owners(mesh.num_vertices(), None);
    std::vector<bool> result(patches.size());
    for (std::size_t place = 0; place < patches.size(); ++place)
        for (const std::uint32_t i : patches[place].triangles)
            for (const std::uint32_t vertex : mesh.triangles[i]) {
                if (owners[vertex] != None && owners[vertex] != place)
                    result[place] = result[owners[vertex]] = true;
                owners[vertex] = place;
            }
    return result;
}

} // namespace

Winding find_winding(const TriangleMesh& mesh) {
    const std::vector<EdgeUse> uses = edge_uses(welded_triangles(mesh));
    Winding result;
    static_cast<void>(settled_patches(mesh, uses, result.is_wrong));
    for (std::uint32_t i = static_cast<std::uint32_t>(result.is_wrong.size()); i-- > 0;)
        if (result.is_wrong[i]) {
            ++result.num_wrong;
            result.first_wrong = i;
        }
    for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
        if (edge.size() == 2 &&
            (edge[0].ascends == edge[1].ascends) ==
                (result.is_wrong[edge[0].triangle()] == result.is_wrong[edge[1].triangle()]))
            ++result.num_one_sided;
    });
    return result;
}

bool faces_with_normals(const TriangleMesh& mesh, std::uint32_t triangle) {
    const Triangle& corners = mesh.triangles[triangle];
    glm::dvec3 sum(0.0);
    for (const std::uint32_t vertex : corners)
        sum += glm::dvec3(mesh.normals[vertex]);
    return glm::dot(sum, area_normal(mesh.positions, corners)) >= 0.0;
}

void turn_triangle(TriangleMesh& mesh, std::uint32_t triangle) {
    std::swap(mesh.triangles[triangle][1], mesh.triangles[triangle][2]);
    if (!mesh.corner_uvs.empty())
        std::swap(mesh.corner_uvs[triangle][1], mesh.corner_uvs[triangle][2]);
    if (!mesh.corner_tangents.empty())
        std::swap(mesh.corner_tangents[triangle][1], mesh.corner_tangents[triangle][2]);
}

void settle_normals(TriangleMesh& mesh) {
    std::vector<bool> is_against(mesh.num_triangles());
    bool is_any = false;
    for (std::uint32_t i = 0; i < mesh.num_triangles(); ++i) {
        is_against[i] = !faces_with_normals(mesh, i);
        is_any = is_any || is_against[i];
    }
    if (!is_any)
        return;
    std::vector<bool> is_wrong, turns(mesh.num_vertices());
    std::size_t num_triangles = 0, num_normals = 0;
    const std::vector<Patch> patches =
        settled_patches(mesh, edge_uses(welded_triangles(mesh)), is_wrong);
    const std::vector<bool> is_joined = patches_that_share(mesh, patches);
    for (std::size_t place = 0; place < patches.size(); ++place) {
        const Patch& patch = patches[place];
        if (is_joined[place])
            continue;
        double against = 0.0, wrong = 0.0;
        for (const std::uint32_t i : patch.triangles) {
            const double area = glm::length(area_normal(mesh.positions, mesh.triangles[i]));
            against += is_against[i] ? area : 0.0;
            wrong += is_wrong[i] ? area : 0.0;
        }
        if (!(2.0 * against > patch.area))
            continue;
        const bool is_winding_wrong = !patch.outwards || 2.0 * wrong > patch.area;
        for (const std::uint32_t i : patch.triangles) {
            if (is_winding_wrong && is_against[i]) {
                turn_triangle(mesh, i);
                ++num_triangles;
            }
            if (!is_winding_wrong)
                for (const std::uint32_t vertex : mesh.triangles[i])
                    turns[vertex] = true;
            if (!is_winding_wrong && !mesh.corner_tangents.empty())
                for (glm::vec4& tangent : mesh.corner_tangents[i])
                    tangent.w = -tangent.w; // v grows as before
        }
    }
    for (std::size_t vertex = 0; vertex < turns.size(); ++vertex)
        if (turns[vertex]) {
            mesh.normals[vertex] = -mesh.normals[vertex];
            ++num_normals;
        }
    if (num_normals != 0)
        mesh.warnings.push_back(
            fmt::format("{} of {} normals look into the mesh, against the winding of its "
                        "triangles: they are turned around",
                        num_normals, mesh.num_vertices()));
    if (num_triangles != 0)
        mesh.warnings.push_back(fmt::format("{} of {} triangles are wound against their normals: "
                                            "they are turned around",
                                            num_triangles, mesh.num_triangles()));
}

} // namespace relumine::mesh
