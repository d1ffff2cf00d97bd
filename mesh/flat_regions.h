// Flat parts of a mesh as few large triangles.
#pragma once

#include <vector>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Triangles over the same vertices that cover the same points of space, where every connected
/// region of exactly coplanar triangles whose outline is convex is one fan: a floor of 73,728
/// triangles becomes two. The rest is unchanged and comes first, in the mesh's order.
///
/// For asking what is hit, not for drawing: a vertex in the middle of a large triangle's side no
/// longer splits it (a T-junction), so rounding may open a gap of 1e-7 between it and a neighbour
/// that still bends there. Whoever traces these must treat rays that pass a side that closely with
/// care.
[[nodiscard]] std::vector<Triangle> with_flat_regions_merged(const TriangleMesh& mesh);

} // namespace relumine::mesh
