#include "mesh/normals.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "mesh/edge_uses.h"
#include "mesh/vertex_copies.h"

namespace relumine::mesh {

namespace {

/// Calls add(corner, weighted normal) for each corner of a triangle with an area.
template<typename Add>
void for_each_corner_normal(const TriangleMesh& mesh, const Add& add) {
    for (std::size_t t = 0; t < mesh.num_triangles(); ++t) {
        const Triangle& triangle = mesh.triangles[t];
        const std::array<glm::dvec3, 3> corners = {glm::dvec3(mesh.positions[triangle[0]]),
                                                   glm::dvec3(mesh.positions[triangle[1]]),
                                                   glm::dvec3(mesh.positions[triangle[2]])};
        const glm::dvec3 area_normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
        const double twice_area = glm::length(area_normal);
        if (twice_area == 0.0)
            continue;
        for (std::size_t i = 0; i < 3; ++i) {
            // |a x b| is twice the area at every corner, so the angle needs one dot product. atan2
            // is exact near 0 and pi.
            const double angle =
                std::atan2(twice_area, glm::dot(corners[(i + 1) % 3] - corners[i],
                                                corners[(i + 2) % 3] - corners[i]));
            add(3 * t + i, area_normal * (angle / twice_area));
        }
    }
}

glm::vec3 unit_or_none(const glm::dvec3& sum) {
    const double length = glm::length(sum);
    return length > 0.0 ? glm::vec3(sum / length) : glm::vec3(0.0f);
}

/// Joins the corners around each vertex over the edges that are smooth.
DisjointSets smooth_corners(const TriangleMesh& mesh, std::span<const Triangle> welded,
                            float degrees) {
    const double least = std::cos(static_cast<double>(degrees) * std::numbers::pi / 180.0);
    DisjointSets sets(3 * welded.size());
    const std::vector<EdgeUse> uses = edge_uses(welded);
    for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
        if (!is_smooth_join(edge))
            return;
        const glm::dvec3 a = area_normal(mesh.positions, welded[edge[0].triangle()]);
        const glm::dvec3 b = area_normal(mesh.positions, welded[edge[1].triangle()]);
        // A triangle without an area bends nothing. The slack keeps an angle that is meant.
        constexpr double Slack = 1e-6;
        if (glm::dot(a, b) < (least - Slack) * glm::length(a) * glm::length(b))
            return;
        const auto next = [](std::uint32_t corner) {
            return corner - corner % 3 + (corner % 3 + 1) % 3;
        };
        sets.join(edge[0].corner, next(edge[1].corner));
        sets.join(next(edge[0].corner), edge[1].corner);
    });
    return sets;
}

} // namespace

std::vector<glm::vec3> smooth_normals(const TriangleMesh& mesh) {
    require_triangles(mesh);
    std::vector<glm::dvec3> sums(mesh.num_vertices(), glm::dvec3(0.0));
    for_each_corner_normal(mesh, [&](std::size_t corner, const glm::dvec3& normal) {
        sums[mesh.triangles[corner / 3][corner % 3]] += normal;
    });
    std::vector<glm::vec3> normals(mesh.num_vertices());
    std::transform(sums.begin(), sums.end(), normals.begin(), unit_or_none);
    return normals;
}

TriangleMesh with_creases(const TriangleMesh& mesh, float degrees) {
    require_triangles(mesh);
    const std::vector<Triangle> welded = renamed(mesh.triangles, first_at_place(mesh.positions));
    DisjointSets sets = smooth_corners(mesh, welded, degrees);
    std::vector<glm::dvec3> sums(3 * mesh.num_triangles(), glm::dvec3(0.0));
    for_each_corner_normal(mesh, [&](std::size_t corner, const glm::dvec3& normal) {
        sums[sets.first(static_cast<std::uint32_t>(corner))] += normal;
    });

    TriangleMesh result = mesh;
    VertexCopies copies(mesh.num_vertices());
    constexpr std::uint32_t None = 0xffffffff;
    // The set of corners that each vertex serves.
    std::vector<std::uint32_t> set_of(mesh.num_vertices(), None);
    for (std::uint32_t corner = 0; corner < 3 * mesh.num_triangles(); ++corner) {
        const std::uint32_t set = sets.first(corner);
        std::uint32_t& vertex = result.triangles[corner / 3][corner % 3];
        vertex = copies.find(vertex, [&](std::uint32_t copy) { return set_of[copy] == set; });
        set_of.resize(copies.num_vertices());
        set_of[vertex] = set;
    }
    for_each_vertex_array(result, [&](auto& values) { copies.append_to(values); });
    result.normals.assign(result.num_vertices(), glm::vec3(0.0f));
    for (std::size_t vertex = 0; vertex < set_of.size(); ++vertex)
        if (set_of[vertex] != None)
            result.normals[vertex] = unit_or_none(sums[set_of[vertex]]);
    return result;
}

} // namespace relumine::mesh
