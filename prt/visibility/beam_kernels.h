// Testing the rays of one receiver through a patch against the triangles of a shaft. Vectorised
// with run-time dispatch.
#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

#include "prt/visibility/shaft.h"
#include "prt/visibility/shaft_leaves.h"
#include "prt/visibility/triangle_tree.h"

namespace relumine::prt {

/// Clears the rays of one receiver that a triangle blocks for certain. Returns the remaining rays
/// that may hit one of the triangles. `origin` is in the mesh's coordinates.
[[nodiscard]] std::uint64_t clear_certain(const TriangleTree& tree, const PatchPlane& patch,
                                          const Shaft& shaft, const ShaftLeaves& leaves,
                                          const glm::vec3& origin, std::uint64_t& rays);

} // namespace relumine::prt
