// Vertex normals from faces.
#pragma once

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Returns smooth vertex normals: the sum of the unit normals of the adjacent faces, weighted by
/// the angle of each corner (Thuermer and Wuethrich, "Computing vertex normals from polygonal
/// facets", 1998). So the result does not depend on how a polygon was cut into triangles. A vertex
/// without a face of positive area gets zero.
///
/// Shape:   [num_vertices].
/// Cost:    O(num_triangles).
[[nodiscard]] std::vector<glm::vec3> smooth_normals(const TriangleMesh& mesh);

} // namespace relumine::mesh
