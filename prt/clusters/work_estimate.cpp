#include "prt/clusters/work_estimate.h"

#include <algorithm>

namespace relumine::prt {

namespace {

// What the first levels of meshes on a floor show, for levels without anything to learn from.
constexpr double FirstShare = 0.7;
constexpr double FirstFall = 0.9;
/// At the deepest levels shares have always fallen, even where they rose before.
constexpr double MostFall = 0.95;
/// Rays of a deeper level are closer together, so a cell takes this part of its
/// parent's time.
constexpr double DeeperCell = 0.7;

} // namespace

void WorkEstimate::add(std::uint32_t level, std::size_t num_cells, std::size_t num_split,
                       double seconds) {
    levels_[level].num_cells += num_cells;
    levels_[level].num_split += num_split;
    levels_[level].seconds += seconds;
    seconds_ += seconds;
}

double WorkEstimate::seconds_of_cell(std::uint32_t level) const {
    double scale = 1.0;
    for (std::uint32_t l = level + 1; l-- > 0; scale *= DeeperCell)
        if (levels_[l].num_cells != 0)
            return scale * levels_[l].seconds / static_cast<double>(levels_[l].num_cells);
    return scale;
}

double WorkEstimate::split_share(std::uint32_t level) const {
    if (level >= max_level_)
        return 0.0;
    const auto measured = [&](std::uint32_t l) {
        return static_cast<double>(levels_[l].num_split) /
               static_cast<double>(levels_[l].num_cells);
    };
    std::uint32_t known = level + 1;
    while (known > 0 && levels_[known - 1].num_cells == 0)
        --known;
    if (known == 0)
        return FirstShare;
    double share = measured(--known);
    const double fall = known > 0 && levels_[known - 1].num_split != 0
                            ? std::min(MostFall, share / measured(known - 1))
                            : FirstFall;
    for (; known < level; ++known)
        share *= fall;
    return share;
}

double WorkEstimate::seconds_of(const Counts& cells) const {
    double seconds = 0.0;
    double expected = 0.0;
    for (std::uint32_t level = 0; level <= max_level_; ++level) {
        expected += static_cast<double>(cells[level]);
        seconds += expected * seconds_of_cell(level);
        expected *= 4.0 * split_share(level);
    }
    return seconds;
}

} // namespace relumine::prt
