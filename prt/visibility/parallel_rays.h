// Testing the rays of a group of receivers in one direction against the triangles before them.
// Vectorised with run-time dispatch.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "prt/visibility/blockers.h"
#include "prt/visibility/shaft.h"
#include "prt/visibility/triangle_tree.h"

namespace relumine::prt {

/// The starts of a group's rays, in the layout that the kernel reads. Lanes after the last receiver
/// repeat the first one.
struct GroupOrigins {
    using Row = std::array<float, ReceiverGroup::MaxSize>;

    GroupOrigins(const ReceiverGroup& group, const TriangleTree& tree);

    /// x, y, z from the tree's centre.
    alignas(64) std::array<Row, 3> from_centre;
    /// x, y, z from the middle of the group.
    alignas(64) std::array<Row, 3> from_middle;
    /// In the mesh's coordinates.
    std::span<const glm::vec3> all;
    /// As in the group.
    glm::vec3 mean_normal{0.0f};
    glm::vec3 middle{0.0f};
    /// Largest coordinate from the middle.
    float radius = 0.0f;
    /// Largest coordinate of the tree's triangles and the origins, from the tree's centre.
    float reach = 0.0f;
};

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

} // namespace relumine::prt
