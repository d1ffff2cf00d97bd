// Testing the rays of a group of receivers through a patch against the triangles of a shaft.
// Vectorised with run-time dispatch.
#pragma once

#include <cstdint>
#include <span>

#include "prt/visibility/group_origins.h"
#include "prt/visibility/see_through.h"
#include "prt/visibility/shaft.h"
#include "prt/visibility/shaft_leaves.h"
#include "prt/visibility/triangle_tree.h"

namespace relumine::prt {

/// A patch, its plane, and the shaft of its rays.
struct BeamPatch {
    const DirectionPatch& directions;
    const PatchPlane& plane;
    const Shaft& shaft;
};

/// What rays pass of a tree's triangles.
struct PassedTriangles {
    const SeeThrough& see_through;
    RayOf of;
};

/// Clears the rays that a triangle blocks for certain, and sets `doubts` to the remaining rays that
/// may hit one of the triangles and be blocked. [receivers of the group], a bit per direction.
/// `passed` is null where no ray passes any; else the tree has the triangles' numbers in the mesh.
void clear_certain(const TriangleTree& tree, const PassedTriangles* passed, const BeamPatch& patch,
                   const ShaftLeaves& leaves, const GroupOrigins& origins,
                   const ReceiverCones& cones, std::span<std::uint64_t> rays,
                   std::span<std::uint64_t> doubts);

} // namespace relumine::prt
