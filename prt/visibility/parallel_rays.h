// Testing the rays of a group of receivers in one direction against the triangles before them.
// Vectorised with run-time dispatch.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "prt/visibility/blockers.h"
#include "prt/visibility/group_origins.h"
#include "prt/visibility/shaft.h"
#include "prt/visibility/triangle_tree.h"

namespace relumine::prt {

/// One bit for each receiver of a group.
using ReceiverBits = std::array<std::uint64_t, ReceiverGroup::MaxSize / 64>;

/// One direction of a patch.
struct PatchDirection {
    const DirectionPatch& patch;
    /// The plane of the same patch.
    const PatchPlane& plane;
    std::size_t index = 0;
};

struct ParallelResult {
    /// Receivers whose ray is blocked for certain.
    ReceiverBits blocked{};
    /// Remaining receivers whose ray may hit something.
    ReceiverBits doubtful{};
    /// Leaves that the rays may meet.
    std::size_t num_leaves = 0;
};

/// Tests the rays of `active` receivers in one direction. Seen along the direction, receivers are
/// points and triangles stay triangles:
///
///          . . .
///      /\ . . . .
///     /__\ . . .
///
/// 16 receivers at a time are compared with one edge at a time, two products each. Receivers that
/// are neighbours on a fine mesh look at the same few triangles, however fine the mesh is. A patch
/// of directions meets more triangles on a finer mesh. Among too many triangles all rays are in
/// doubt.
[[nodiscard]] ParallelResult test_parallel_rays(const TriangleTree& tree,
                                                const PatchDirection& of_patch,
                                                const GroupOrigins& origins,
                                                const ReceiverBits& active);

/// Returns how many leaves the rays of `active` receivers in one direction may meet; more than a
/// thousand are not all counted.
[[nodiscard]] std::size_t num_leaves_along(const TriangleTree& tree, const PatchDirection& of_patch,
                                           const GroupOrigins& origins, const ReceiverBits& active);

} // namespace relumine::prt
