// The mesh doctor: what is odd about a mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Two vertices; of an edge, the smaller index first.
using VertexPair = std::array<std::uint32_t, 2>;

/// What is odd about a mesh, and where. Edges join vertices by index; a triangle that has a vertex
/// twice has no edges. Lists ascend.
struct Diagnosis {
    /// Edges of one triangle.
    std::vector<VertexPair> boundary_edges;
    /// How many of them lie on seams: other vertices at the same two positions have an edge, too.
    std::size_t num_seam_edges = 0;
    /// Edges of three triangles or more.
    std::vector<VertexPair> non_manifold_edges;
    /// Sides, from a vertex to another, that two triangles or more have: they are wound against
    /// each other, or the surface is not manifold there.
    std::vector<VertexPair> repeated_sides;
    /// Vertices whose triangles are several fans: there are two of them that no walk from edge to
    /// edge around the vertex joins.
    std::vector<std::uint32_t> non_manifold_vertices;
    /// Vertices of no triangle.
    std::vector<std::uint32_t> isolated_vertices;
    /// Triangles whose area is 0, computed in double.
    std::vector<std::uint32_t> zero_area;
    /// Triangles with the same three vertices as an earlier one, in any order.
    std::vector<std::uint32_t> duplicates;
    /// Triangles of positive area whose vertex normals point to their back.
    std::vector<std::uint32_t> against_normals;
    /// Triangles that repair() would turn: see find_winding().
    std::vector<std::uint32_t> wrongly_wound;
    /// Edges whose triangles no turning makes consistent, as on a Moebius strip.
    std::size_t num_one_sided = 0;
    /// Sets of triangles that no shared vertex joins.
    std::size_t num_components = 0;

    /// Every edge has a triangle on either side, if vertices at one place count as one.
    [[nodiscard]] bool is_closed() const { return boundary_edges.size() == num_seam_edges; }
};

/// Cost:    O(n log n).
[[nodiscard]] Diagnosis diagnose(const TriangleMesh& mesh);

} // namespace relumine::mesh
