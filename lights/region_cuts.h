// Cuts a lat-long into regions with one light each. Median cut and variance minimisation share
// these functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

#include "lights/lat_long_grid.h"
#include "lights/light_list.h"

namespace relumine::lights {

/// The two parts of a region.
using Halves = std::pair<PixelRectangle, PixelRectangle>;

/// Return the parts left and right of column `at`, or above and below row `at`.
[[nodiscard]] Halves cut_at_column(const PixelRectangle& region, std::uint32_t at);
[[nodiscard]] Halves cut_at_row(const PixelRectangle& region, std::uint32_t at);

/// Returns true if a region is to be cut at a column: the width is the longest dimension of [D05]
/// and has more than one pixel, or the height has only one.
[[nodiscard]] bool is_cut_at_column(const LatLongGrid& grid, const PixelRectangle& region);

/// Cuts a region in the middle of its longest dimension; used for regions without light. The region
/// has at least two pixels.
[[nodiscard]] Halves cut_in_the_middle(const LatLongGrid& grid, const PixelRectangle& region);

/// Cuts regions until there are `num_regions`, at most the number of pixels of `grid`. The next
/// region to cut is the one with the largest `weight(region)`, then the largest solid angle, then
/// the lowest index. `cut(region)` gets regions of at least two pixels. The first half takes the
/// place of its region; the second goes to the end.
template<typename Weight, typename Cut>
void cut_heaviest(const LatLongGrid& grid, std::vector<PixelRectangle>& regions,
                  std::size_t num_regions, const Weight& weight, const Cut& cut) {
    struct Entry {
        double weight, solid_angle;
        std::size_t index;
        bool operator<(const Entry& other) const {
            return std::tie(weight, solid_angle, other.index) <
                   std::tie(other.weight, other.solid_angle, index);
        }
    };
    std::priority_queue<Entry> queue;
    const auto push = [&](std::size_t index) {
        const PixelRectangle& region = regions[index];
        if (region.width() > 1 || region.height() > 1)
            queue.push({weight(region), grid.solid_angle(region), index});
    };
    for (std::size_t i = 0; i < regions.size(); ++i)
        push(i);
    while (regions.size() < num_regions) {
        const std::size_t index = queue.top().index;
        queue.pop();
        const Halves halves = cut(regions[index]);
        regions[index] = halves.first;
        regions.push_back(halves.second);
        push(index);
        push(regions.size() - 1);
    }
}

/// Returns one light per region. Its irradiance is the sum of radiance times solid angle over the
/// region's pixels. Its direction is the centroid of the region's energy on the sphere, or the
/// region's centre if there is no energy or no centroid (a whole sphere of constant radiance).
///
/// Differs from [D05]: the centroid is taken over directions, not pixel coordinates, so it is right
/// near the poles.
[[nodiscard]] std::vector<DistantLight> lights_of(const LatLongGrid& grid,
                                                  const std::vector<PixelRectangle>& regions);

} // namespace relumine::lights
