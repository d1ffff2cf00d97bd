// The ground plane of Johan and Nishita's scenes.
#pragma once

#include <cstdint>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Appends a square grid of n x n vertices (n >= 2), facing +Y, centred under the mesh's bounding
/// box at its lowest point, with sides of `scale` times the box's larger horizontal extent (times
/// its diagonal where it has none). The mesh's own vertices keep their place; the floor's follow,
/// rows along +X, row after row along +Z. Normals, colours and uvs are extended where the mesh has
/// them: (0, 1, 0), white, (0, 0); so are materials, by a white Lambert one named "floor". The
/// floor is a group "floor" of its own; a mesh without groups becomes "mesh".
/// [JN] Table 1 is reproduced by n = 193: 37,249 vertices more. Throws std::invalid_argument for n
/// < 2, for a mesh without extent, for a scale that is not positive, and for a floor that needs
/// more than 32-bit indices or float coordinates.
void append_floor(TriangleMesh& mesh, std::uint32_t n = 193, float scale = 4.0f);

} // namespace relumine::mesh
