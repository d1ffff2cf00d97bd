#include "mesh/half_edge/diagnosis.h"

#include <algorithm>

#include <glm/geometric.hpp>

#include "mesh/edge_uses.h"
#include "mesh/half_edge/winding.h"

namespace relumine::mesh {

namespace {

void diagnose_edges(const TriangleMesh& mesh, Diagnosis& result) {
    const std::vector<EdgeUse> uses = edge_uses(mesh.triangles);
    for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
        const VertexPair pair = {edge[0].low, edge[0].high};
        if (edge.size() == 1)
            result.boundary_edges.push_back(pair);
        else if (edge.size() > 2)
            result.non_manifold_edges.push_back(pair);
        const auto num_ascending =
            std::count_if(edge.begin(), edge.end(), [](const EdgeUse& use) { return use.ascends; });
        if (num_ascending > 1)
            result.repeated_sides.push_back(pair);
        if (static_cast<std::ptrdiff_t>(edge.size()) - num_ascending > 1)
            result.repeated_sides.push_back({pair[1], pair[0]});
    });

    std::sort(result.repeated_sides.begin(), result.repeated_sides.end());

    // Corners of a vertex belong to one fan where their triangles share an edge at it.
    DisjointSets fans(3 * mesh.num_triangles());
    const auto corner_at = [&](std::uint32_t triangle, std::uint32_t vertex) {
        const Triangle& corners = mesh.triangles[triangle];
        return 3 * triangle + (corners[0] == vertex ? 0u : corners[1] == vertex ? 1u : 2u);
    };
    for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
        for (const EdgeUse& use : edge.subspan(1))
            for (const std::uint32_t vertex : {use.low, use.high})
                fans.join(corner_at(edge[0].triangle(), vertex), corner_at(use.triangle(), vertex));
    });
    std::vector<std::uint32_t> num_fans(mesh.num_vertices());
    for (const EdgeUse& use : uses) // the start of each side is a corner
        if (fans.first(use.corner) == use.corner)
            ++num_fans[mesh.triangles[use.triangle()][use.corner % 3]];
    for (std::uint32_t vertex = 0; vertex < num_fans.size(); ++vertex)
        if (num_fans[vertex] > 1)
            result.non_manifold_vertices.push_back(vertex);
}

/// Counts the boundary edges that vertices at equal positions close.
void count_seams(const TriangleMesh& mesh, Diagnosis& result) {
    const std::vector<std::uint32_t> first = first_at_place(mesh.positions);
    const std::vector<Triangle> welded = renamed(mesh.triangles, first);
    const std::vector<EdgeUse> uses = edge_uses(welded);
    for (const auto& [a, b] : result.boundary_edges) {
        const EdgeUse edge{.low = std::min(first[a], first[b]),
                           .high = std::max(first[a], first[b])};
        const auto [begin, end] = std::equal_range(
            uses.begin(), uses.end(), edge, [](const EdgeUse& x, const EdgeUse& y) {
                return VertexPair{x.low, x.high} < VertexPair{y.low, y.high};
            });
        result.num_seam_edges += end - begin > 1 ? 1 : 0;
    }
}

void diagnose_triangles(const TriangleMesh& mesh, Diagnosis& result) {
    std::vector<std::array<std::uint32_t, 4>> sorted; // the vertices, then the triangle
    for (std::uint32_t i = 0; i < mesh.num_triangles(); ++i) {
        Triangle triangle = mesh.triangles[i];
        if (glm::length(area_normal(mesh.positions, triangle)) == 0.0)
            result.zero_area.push_back(i);
        else if (!mesh.normals.empty() && !faces_with_normals(mesh, i))
            result.against_normals.push_back(i);
        std::sort(triangle.begin(), triangle.end());
        sorted.push_back({triangle[0], triangle[1], triangle[2], i});
    }
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t i = 1; i < sorted.size(); ++i)
        if (std::equal(sorted[i].begin(), sorted[i].begin() + 3, sorted[i - 1].begin()))
            result.duplicates.push_back(sorted[i][3]);
    std::sort(result.duplicates.begin(), result.duplicates.end());
}

void diagnose_vertices(const TriangleMesh& mesh, Diagnosis& result) {
    DisjointSets components(mesh.num_vertices());
    std::vector<bool> is_used(mesh.num_vertices());
    for (const auto& [a, b, c] : mesh.triangles) {
        components.join(a, b);
        components.join(a, c);
        is_used[a] = is_used[b] = is_used[c] = true;
    }
    for (std::uint32_t vertex = 0; vertex < mesh.num_vertices(); ++vertex) {
        if (!is_used[vertex])
            result.isolated_vertices.push_back(vertex);
        else if (components.first(vertex) == vertex)
            ++result.num_components;
    }
}

} // namespace

Diagnosis diagnose(const TriangleMesh& mesh) {
    Diagnosis result;
    diagnose_edges(mesh, result);
    count_seams(mesh, result);
    diagnose_triangles(mesh, result);
    diagnose_vertices(mesh, result);
    const Winding winding = find_winding(mesh);
    for (std::uint32_t i = 0; i < winding.is_wrong.size(); ++i)
        if (winding.is_wrong[i])
            result.wrongly_wound.push_back(i);
    result.num_one_sided = winding.num_one_sided;
    return result;
}

} // namespace relumine::mesh
