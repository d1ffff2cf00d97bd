// Merges the flat parts of a mesh into few large triangles.
#pragma once

#include <vector>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Returns triangles over the same vertices that cover the same points of space. Every connected
/// region of exactly coplanar triangles with a convex outline becomes one fan: a floor of 73,728
/// triangles becomes two. The other triangles are unchanged and come first, in the mesh's order.
///
/// The result is for asking what a ray hits, not for drawing. A vertex in the middle of a large
/// triangle's side no longer splits the side (a T-junction). Rounding may then open a gap of 1e-7
/// between the side and a neighbour that still bends at the vertex. A caller must treat rays that
/// pass so close to a side with care.
[[nodiscard]] std::vector<Triangle> with_flat_regions_merged(const TriangleMesh& mesh);

} // namespace relumine::mesh
