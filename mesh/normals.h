// Vertex normals from faces.
#pragma once

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Where the vertex normals come from.
enum class NormalSource {
    /// The file's normals if it has one for every vertex, smooth normals otherwise.
    File,
    /// Normals are always computed from the faces.
    Smooth,
};

/// Returns smooth vertex normals: the sum of the unit normals of the adjacent faces, weighted by
/// the angle of each corner (Thuermer and Wuethrich, "Computing vertex normals from polygonal
/// facets", 1998). So the result does not depend on how a polygon was cut into triangles. A vertex
/// without a face of positive area gets zero.
///
/// Shape:   [num_vertices].
/// Throws:  as require_triangles().
/// Cost:    O(num_triangles).
[[nodiscard]] std::vector<glm::vec3> smooth_normals(const TriangleMesh& mesh);

/// Returns the mesh with normals that are smooth over edges of at most `degrees` between the
/// normals of their two triangles, and broken beyond, weighted by angles as above. Rims and edges
/// of more triangles, or of two that are wound against each other, are broken, too. Vertices at
/// equal positions are smooth across their seam. A vertex becomes several only where its normal
/// breaks: the first keeps its place, the others follow all vertices of the mesh, with its
/// attributes.
///
/// Throws:  as require_triangles().
/// Cost:    O(n log n).
[[nodiscard]] TriangleMesh with_creases(const TriangleMesh& mesh, float degrees);

} // namespace relumine::mesh
