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

/// Where a group's rays start, in the layout that the kernel reads. Receivers beyond the group's
/// size repeat its first.
struct GroupOrigins {
    using Row = std::array<float, ReceiverGroup::MaxSize>;

    GroupOrigins(const ReceiverGroup& group, const TriangleTree& tree);

    /// x, y, z from the tree's centre
    alignas(64) std::array<Row, 3> from_centre;
    /// From the middle of the group
    alignas(64) std::array<Row, 3> from_middle;
    /// As they are
    std::span<const glm::vec3> all;
    /// As the group has it
    glm::vec3 mean_normal{0.0f};
    glm::vec3 middle{0.0f};
    /// Largest coordinate from the middle
    float radius = 0.0f;
    /// Largest coordinate of the tree's triangles and the origins, from the tree's centre
    float reach = 0.0f;
};

/// One bit for each receiver of a group.
using ReceiverBits = std::array<std::uint64_t, ReceiverGroup::MaxSize / 64>;

/// One direction of a patch.
struct PatchDirection {
    const DirectionPatch& patch;
    /// The patch's own
    const PatchPlane& plane;
    std::size_t index = 0;
};

struct ParallelResult {
    /// For certain
    ReceiverBits blocked{};
    /// Of the rest, those that are not certain to miss everything
    ReceiverBits doubtful{};
    /// That the rays may meet
    std::size_t num_leaves = 0;
};

/// Tests the rays of `active` receivers in one direction. Seen along it, receivers are
/// points and triangles stay triangles:
///
///          . . .             16 receivers at a time are compared with one edge at a time, two
///          products each. Receivers that are
///      /\ . . . .            neighbours on a fine mesh look at the same few triangles, however
///      fine it is, while a patch
///     /__\ . . .             of directions meets more and more.
///
/// Rays among too many triangles are all in doubt.
[[nodiscard]] ParallelResult test_parallel_rays(const TriangleTree& tree,
                                                const PatchDirection& of_patch,
                                                const GroupOrigins& origins,
                                                const ReceiverBits& active);

} // namespace relumine::prt
