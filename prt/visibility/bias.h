// How far off their surface rays start.
#pragma once

#include "mesh/triangle_mesh.h"

namespace relumine::prt {

/// Returns the bias to use where none is given: 1e-4 of the blockers' mesh::scale(). It is
/// a thousand times the spacing of floats at that size, and well below the edge length of a
/// mesh of a million triangles.
///
/// Far from the origin floats are so sparse that such a bias would be rounded away, and every
/// surface would block its own light. There the bias is four spacings of floats.
[[nodiscard]] float automatic_bias(const mesh::TriangleMesh& blockers);

} // namespace relumine::prt
