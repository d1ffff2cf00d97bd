// Writes binary glTF 2.0.
#pragma once

#include <span>
#include <string>

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

/// Returns the mesh as it is: positions, normals, and colours where it has them; a primitive
/// for each material that triangles use, with its numbers, without images. There are no uvs: other
/// formats count v from the other end, and a mesh does not say which.
///
/// Throws:  as above.
[[nodiscard]] std::string glb(const TriangleMesh& mesh);

} // namespace relumine::mesh
