// How much of the clustering's time is still to come.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "prt/transfer/quadtree.h"

namespace relumine::prt {

/// Learns from the levels of the quadtree how long a cell takes, and from the cells of the last one
/// how many levels will follow. A cell is split while the squared distance of its transfer vectors
/// is too large [JN, Eq. 11]. Where shadows' edges cross a cell, half of the edges cross a child,
/// so a child has about half the squared distance.
class WorkEstimate {
public:
    /// Cells of a level, one number for each.
    using Counts = std::array<std::size_t, MaxLevel + 1>;
    /// Tested cells by the levels that are expected below them, one number for each: first the
    /// clusters.
    using Depths = std::array<std::size_t, MaxLevel + 1>;

    /// Returns how many levels are expected below a cell whose squared distance is so many times
    /// the allowed one: none below 1.
    [[nodiscard]] static std::uint8_t expected_depth(double excess);

    /// Cells of `max_level` are never split. As long as nothing was added, the number of levels is
    /// guessed from `tolerance`, a PrecomputeOptions::tolerance.
    WorkEstimate(std::uint32_t max_level, float tolerance);

    /// Says that cells of one level were tested, and how long it took.
    void add(std::uint32_t level, const Depths& cells, double seconds);

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
        /// Cells with at least so many levels below: first all cells.
        Depths deeper{};
        double seconds = 0.0;
    };
    std::array<Level, MaxLevel + 1> levels_;
    std::uint32_t max_level_;
    double first_share_;
    double seconds_ = 0.0;
};

} // namespace relumine::prt
