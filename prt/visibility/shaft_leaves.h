// The triangles that a shaft of rays may meet. Vectorised with run-time dispatch.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prt/visibility/shaft.h"
#include "prt/visibility/triangle_tree.h"

namespace relumine::prt {

/// The leaves in a shaft, found by their boxes. Reuse the object for the next shaft to keep its
/// memory.
struct ShaftLeaves {
    struct Found {
        /// For each plane, the maximum of normal . x over the box.
        std::array<float, Shaft::NumPlanes> supports;
        /// Where the box begins along the shaft's axis.
        float near = 0.0f;
        std::int32_t leaf = 0;
        /// Its box is box `lane` of this node.
        std::int32_t node = 0;
        std::uint32_t lane = 0;
    };
    std::vector<Found> found;
    /// Indices into `found`, nearly from near to far.
    std::vector<std::uint32_t> order;
    std::vector<std::int32_t> stack;
};

/// Collects the leaves whose boxes reach to the inner side of each of the shaft's planes. Returns
/// false for more than `most` leaves; some have not been looked at then.
[[nodiscard]] bool find_leaves(const TriangleTree& tree, const Shaft& shaft, std::size_t most,
                               ShaftLeaves& leaves);

} // namespace relumine::prt
