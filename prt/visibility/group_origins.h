// The starts of a group's rays, and the cone of each receiver, in the layout that kernels read.
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

/// One value for each receiver of a group.
using ReceiverRow = std::array<float, ReceiverGroup::MaxSize>;

/// The starts of a group's rays. Lanes after the last receiver repeat the first one.
struct GroupOrigins {
    /// The group must not be empty, and must outlive this object.
    GroupOrigins(const ReceiverGroup& group, const TriangleTree& tree);

    /// x, y, z in the mesh's coordinates.
    alignas(64) std::array<ReceiverRow, 3> rows;
    /// x, y, z from the tree's centre.
    alignas(64) std::array<ReceiverRow, 3> from_centre;
    /// x, y, z from the middle of the group.
    alignas(64) std::array<ReceiverRow, 3> from_middle;
    /// In the mesh's coordinates.
    std::span<const glm::vec3> all;
    /// A hint where the receivers face, of any length (ReceiverGroup::mean_normal).
    glm::vec3 mean_normal{0.0f};
    /// A box around all, in the mesh's coordinates, and its middle.
    glm::vec3 low{0.0f}, high{0.0f}, middle{0.0f};
    /// Largest coordinate from the middle.
    float radius = 0.0f;
    /// Largest coordinate of the tree's triangles and the origins, from the tree's centre.
    float reach = 0.0f;
};

/// The shaft's planes moved to each receiver: its own cone. Offsets are infinite where a receiver
/// has no rays, which leaves everything outside.
struct ReceiverCones {
    /// Receivers of a bundle: neighbours with a cone around all of theirs.
    static constexpr std::size_t BundleSize = 16;
    static constexpr std::size_t NumBundles = ReceiverGroup::MaxSize / BundleSize;

    alignas(64) std::array<ReceiverRow, Shaft::NumPlanes> offsets;
    alignas(64) std::array<std::array<float, NumBundles>, Shaft::NumPlanes> of_bundles;
};

/// Moves the planes of a shaft so that they hold the rays of all receivers with a bit in `rays`,
/// and returns each receiver's cone.
[[nodiscard]] ReceiverCones place_shaft(const GroupOrigins& origins,
                                        std::span<const std::uint64_t> rays, Shaft& shaft);

} // namespace relumine::prt
