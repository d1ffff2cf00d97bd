// Coarser meshes.
#pragma once

#include <cstddef>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Returns the mesh with so many of its vertices, those that shape it most: half-edges collapse,
/// the cheapest in the error of quadrics first (M. Garland, P. S. Heckbert: Surface Simplification
/// Using Quadric Error Metrics, 1997). The vertices that stay have their positions, normals,
/// colours and uvs, and keep their order.
///
/// Vertices on rims, on seams of uvs, on borders of materials and groups, and where more than two
/// triangles meet at an edge, stay. No triangle turns by more than `largest_turn` degrees in one
/// collapse. So more vertices may remain than were asked for.
///
/// Throws:  std::invalid_argument for fewer than 4 vertices.
/// Cost:    O(n log n), on one thread.
[[nodiscard]] TriangleMesh simplified(const TriangleMesh& mesh, std::size_t num_vertices,
                                      float largest_turn = 45.0f);

} // namespace relumine::mesh
