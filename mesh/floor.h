// The ground plane of Johan and Nishita's scenes.
#pragma once

#include <cstdint>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Appends a square grid of n x n vertices that faces +Y. The grid is centred under the mesh's
/// bounding box, at its lowest point. Its sides are `scale` times the larger horizontal extent of
/// the box, or times its diagonal if there is no horizontal extent.
///
/// The mesh's own vertices keep their places. The floor's vertices follow, rows along +X, row after
/// row along +Z. Arrays that the mesh has are extended: normals by (0, 1, 0), colours by white, uvs
/// by (0, 0), materials by a white Lambert one named "floor". The floor is a group "floor" of its
/// own; a mesh without groups becomes a group "mesh".
///
/// n = 193 reproduces [JN] Table 1: 37,249 additional vertices.
///
/// Throws:  std::invalid_argument for n < 2, a mesh without extent, a scale that is not positive,
///          and a floor that needs more than 32-bit indices or float coordinates.
void append_floor(TriangleMesh& mesh, std::uint32_t n = 193, float scale = 4.0f);

} // namespace relumine::mesh
