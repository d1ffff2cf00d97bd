// The triangles that a shaft of rays may meet. Vectorised with run-time dispatch.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prt/visibility/shaft.h"
#include "prt/visibility/triangle_tree.h"

namespace relumine::prt {

/// The leaves in a shaft, from near to far, by their triangles. Kept from shaft to shaft for its
/// memory.
struct ShaftLeaves {
    static constexpr std::size_t MaxSize = 2048;
    static constexpr std::size_t Padding = 16;
    using Row = std::array<float, MaxSize + Padding>;

    std::size_t size = 0;
    /// max over a leaf's triangles of normal . x, for each plane; [size], then lanes that are
    /// outside of everything
    std::array<Row, Shaft::NumPlanes> supports;
    /// the boxes in the patch's axes: low and high along `axis` (times its sign), along s, along t
    std::array<Row, 6> boxes;
    std::array<std::int32_t, MaxSize + Padding> leaves;

    struct Found {
        std::int32_t node = 0;
        std::uint32_t lane = 0;
        std::int32_t leaf = 0;
    };
    /// Before their triangles are looked at
    std::vector<Found> found;
    /// Sorted from near to far; the lower 32 bits are places in `found`
    std::vector<std::uint64_t> order;
    std::vector<std::int32_t> stack;
};

/// Finds the leaves of which no plane says that all their triangles are outside. False when they
/// are more than `most` (at most MaxSize), without having looked at all of them.
[[nodiscard]] bool find_leaves(const TriangleTree& tree, const Shaft& shaft, std::size_t most,
                               ShaftLeaves& leaves);

/// The leaves in a shaft, from near to far, by their boxes alone, which is faster where many shafts
/// are looked into. Kept for its memory, too.
struct ShaftBoxes {
    struct Found {
        /// Max over the box of normal . x, for each plane
        std::array<float, Shaft::NumPlanes> supports;
        std::int32_t leaf = 0;
    };
    std::vector<Found> found;
    /// Sorted from near to far; the lower 32 bits are places in `found`
    std::vector<std::uint64_t> order;
    std::vector<std::int32_t> stack;
};

/// Finds the leaves whose boxes are not outside of one of the planes. False when they are more than
/// `most`.
[[nodiscard]] bool find_boxes(const TriangleTree& tree, const Shaft& shaft, std::size_t most,
                              ShaftBoxes& boxes);

} // namespace relumine::prt
