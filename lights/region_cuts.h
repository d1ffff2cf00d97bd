// Cutting a lat-long into regions, one light each: what median cut and variance minimisation share.
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

/// A region's two parts.
using Halves = std::pair<PixelRectangle, PixelRectangle>;

/// The parts left and right of column `at` (or above and below row `at`).
[[nodiscard]] Halves cut_at_column(const PixelRectangle& region, std::uint32_t at);
[[nodiscard]] Halves cut_at_row(const PixelRectangle& region, std::uint32_t at);

/// True if a region is cut across its width: [D05]'s longest dimension, unless that is a single
/// pixel.
[[nodiscard]] bool is_cut_at_column(const LatLongGrid& grid, const PixelRectangle& region);

/// The cut in the middle of the longest dimension, for regions without light. The region has two
/// pixels at least.
[[nodiscard]] Halves cut_in_the_middle(const LatLongGrid& grid, const PixelRectangle& region);

/// Regions in the order they came to be, until there are `num_regions` (at most the pixels of
/// `grid`). `weight(region)` says which to cut next: the heaviest, then that of the largest solid
/// angle, then the first; `cut(region)` cuts one of two pixels or more.
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

/// One light per region: irradiance the sum of radiance times solid angle of its pixels; direction
/// the centroid of its energy on the sphere, or the region's centre where it has no energy or none
/// in particular (a whole sphere of constant radiance). Differs from [D05]: the centroid of
/// directions, not of pixel coordinates, so that it is right near the poles.
[[nodiscard]] std::vector<DistantLight> lights_of(const LatLongGrid& grid,
                                                  const std::vector<PixelRectangle>& regions);

} // namespace relumine::lights
