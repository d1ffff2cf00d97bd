// Vertex normals from faces.
#pragma once

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Smooth vertex normals, [num_vertices]: the sum of the adjacent faces' unit normals weighted by
/// the corner's angle (Thuermer and Wuethrich, "Computing vertex normals from polygonal facets",
/// 1998), so that the result does not depend on how a polygon was cut into triangles. Zero for a
/// vertex without a face of positive area. O(num_triangles).
[[nodiscard]] std::vector<glm::vec3> smooth_normals(const TriangleMesh& mesh);

} // namespace relumine::mesh
