#include "prt/clusters/work_estimate.h"

#include <algorithm>
#include <cmath>

namespace relumine::prt {

namespace {

/// Rays of a deeper level are closer together, so a cell takes this part of its parent's time.
constexpr double DeeperCell = 0.6;

/// The part of cells that are split, for levels without anything to learn from. All levels then
/// take 55, 20, 2 and 1.5 times the first one for tolerances 0.01, 0.0135, 0.03 and 0.05, about as
/// those of the bunny on its floor do.
double first_share(float tolerance) {
    constexpr float ShareTimesTolerance = 0.00675f, Most = 0.6f;
    return static_cast<double>(std::min(ShareTimesTolerance / tolerance, Most));
}

} // namespace

WorkEstimate::WorkEstimate(std::uint32_t max_level, float tolerance)
    : max_level_(max_level), first_share_(first_share(tolerance)) {}

std::uint8_t WorkEstimate::expected_depth(double excess) {
    if (!(excess >= 1.0))
        return 0;
    return static_cast<std::uint8_t>(
        std::min(1.0 + std::floor(std::log2(excess)), double{MaxLevel}));
}

void WorkEstimate::add(std::uint32_t level, const Depths& cells, double seconds) {
    std::size_t num_deeper = 0;
    for (std::size_t depth = cells.size(); depth-- > 0;) {
        num_deeper += cells[depth];
        levels_[level].deeper[depth] += num_deeper;
    }
    levels_[level].seconds += seconds;
    seconds_ += seconds;
}

double WorkEstimate::seconds_of_cell(std::uint32_t level) const {
    double scale = 1.0;
    for (std::uint32_t l = level + 1; l-- > 0; scale *= DeeperCell)
        if (levels_[l].deeper[0] != 0)
            return scale * levels_[l].seconds / static_cast<double>(levels_[l].deeper[0]);
    return scale;
}

double WorkEstimate::split_share(std::uint32_t level) const {
    if (level >= max_level_)
        return 0.0;
    std::uint32_t known = level + 1;
    while (known > 0 && levels_[known - 1].deeper[0] == 0)
        --known;
    if (known == 0)
        return first_share_;
    const Depths& deeper = levels_[--known].deeper;
    const std::uint32_t depth = level - known;
    return deeper[depth] == 0
               ? 0.0
               : static_cast<double>(deeper[depth + 1]) / static_cast<double>(deeper[depth]);
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
