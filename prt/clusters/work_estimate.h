// How much of the clustering's time is still to come.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "prt/clusters/quadtree.h"

namespace relumine::prt {

/// Learns from the levels of the quadtree how many cells are split and how long a cell takes, and
/// expects the deeper levels to go on in the same way: what share is split, and how it falls from
/// level to level.
class WorkEstimate {
public:
    /// Cells of a level, one number for each.
    using Counts = std::array<std::size_t, MaxLevel + 1>;

    /// Cells of `max_level` are never split.
    explicit WorkEstimate(std::uint32_t max_level) : max_level_(max_level) {}

    /// Says that cells of one level were tested, how many of them were split, and how long it took.
    void add(std::uint32_t level, std::size_t num_cells, std::size_t num_split, double seconds);

    /// Returns the time of all that was added.
    [[nodiscard]] double seconds() const { return seconds_; }

    /// Returns the time that one cell of a level takes, without its children. The unit is any one
    /// as long as nothing was added.
    [[nodiscard]] double seconds_of_cell(std::uint32_t level) const;

    /// Returns the time that the cells will take, with all the cells that will come of them.
    [[nodiscard]] double seconds_of(const Counts& cells) const;

private:
    [[nodiscard]] double split_share(std::uint32_t level) const;

    struct Level {
        std::size_t num_cells = 0;
        std::size_t num_split = 0;
        double seconds = 0.0;
    };
    std::array<Level, MaxLevel + 1> levels_;
    std::uint32_t max_level_;
    double seconds_ = 0.0;
};

} // namespace relumine::prt
