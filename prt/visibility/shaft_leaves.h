// The triangles that a shaft of rays may meet. Vectorised with run-time dispatch.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prt/visibility/shaft.h"
#include "prt/visibility/triangle_tree.h"

namespace relumine::prt {

/// The leaves in a shaft from near to far, found by their triangles. Reuse the object for the next
/// shaft to keep its memory.
struct ShaftLeaves {
    static constexpr std::size_t MaxSize = 2048;
    static constexpr std::size_t Padding = 16;
    using Row = std::array<float, MaxSize + Padding>;

    std::size_t size = 0;
    /// [size] for each plane: the maximum of normal . x over a leaf's triangles. The lanes after
    /// `size` are outside of everything.
    std::array<Row, Shaft::NumPlanes> supports;
    /// [size] the boxes in the patch's axes: low and high along `axis` (times its sign), along s,
    /// along t.
    std::array<Row, 6> boxes;
    std::array<std::int32_t, MaxSize + Padding> leaves;

    struct Found {
        std::int32_t node = 0;
        std::uint32_t lane = 0;
        std::int32_t leaf = 0;
    };
    /// Candidates, before their triangles are looked at.
    std::vector<Found> found;
    /// Sorted from near to far. The lower 32 bits are indices into `found`.
    std::vector<std::uint64_t> order;
    std::vector<std::int32_t> stack;
};

/// Collects the leaves that may lie inside the shaft: for each of its six planes, at least one
/// triangle is on the inner side. Returns false for more than `most` leaves (at most MaxSize); some
/// leaves have not been looked at then.
[[nodiscard]] bool find_leaves(const TriangleTree& tree, const Shaft& shaft, std::size_t most,
                               ShaftLeaves& leaves);

/// The leaves in a shaft from near to far, found by their boxes alone. Faster than ShaftLeaves for
/// many shafts. Reuse the object to keep its memory.
struct ShaftBoxes {
    struct Found {
        /// For each plane, the maximum of normal . x over the box.
        std::array<float, Shaft::NumPlanes> supports;
        std::int32_t leaf = 0;
    };
    std::vector<Found> found;
    /// Sorted from near to far. The lower 32 bits are indices into `found`.
    std::vector<std::uint64_t> order;
    std::vector<std::int32_t> stack;
};

/// Collects the leaves whose boxes reach to the inner side of every plane. Returns false for more
/// than `most` leaves.
[[nodiscard]] bool find_boxes(const TriangleTree& tree, const Shaft& shaft, std::size_t most,
                              ShaftBoxes& boxes);

} // namespace relumine::prt
