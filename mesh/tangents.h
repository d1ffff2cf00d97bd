// Tangents for normal maps and stretched highlights.
//
// Based on: M. Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008, whose convention
// (MikkTSpace) programs that bake normal maps share.
#pragma once

#include <span>

#include <glm/vec4.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Sets TriangleMesh::corner_tangents of the triangles with a normal map or a stretched highlight,
/// if there are any: those of the file where it has them, otherwise the directions in which u
/// grows. Corners of equal position, normal, uv and handedness share the mean of their triangles,
/// weighted by angles.
///
/// `of_file` is [num_vertices], with the bitangent's sign in w, or empty. All four numbers are 0
/// where the file has none. Tangents that are not finite, or of no length, are computed, with a
/// warning.
///
/// Cost:    O(n log n) of the triangles with a normal map.
void set_tangents(TriangleMesh& mesh, std::span<const glm::vec4> of_file);

/// Returns the mesh's uv at a corner, of a set.
[[nodiscard]] glm::vec2 corner_uv(const TriangleMesh& mesh, std::uint32_t triangle,
                                  std::size_t corner, std::uint32_t uv_set);

} // namespace relumine::mesh
