// Writes binary glTF 2.0.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Returns the mesh as one .glb file: POSITION, NORMAL, COLOR_0 (linear RGB, floats from 0 to 1, as
/// the format demands), _RADIANCE (linear RGB, floats) and 32-bit indices, with an unlit material.
/// glTF has no zero normals; (0, 1, 0) stands for them. The mesh must have triangles, and all
/// numbers must be finite.
///
/// Shape:   `radiance` is [num_vertices].
/// Throws:  std::runtime_error "expected X, got Y" for a mesh that is too large for the format (4
///          GiB).
[[nodiscard]] std::string lit_glb(const TriangleMesh& mesh, std::span<const glm::vec3> radiance);

/// Returns the mesh as it is: positions, normals, uvs, and colours where it has them; a node for
/// each group, and in it a primitive for each material that triangles use. Materials have their
/// numbers and the images of their textures, in the files that they came from. Without groups all
/// vertices keep their numbers, unless some have several uvs: those come again behind the others.
/// Uvs of other formats count v from below, and are turned.
///
/// Adds what is left out, a line each.
/// Throws:  as above.
[[nodiscard]] std::string glb(const TriangleMesh& mesh, std::vector<std::string>& left_out);

} // namespace relumine::mesh
