// Regions of equal energy.
// Based on: [D05] P. Debevec, "A Median Cut Algorithm for Light Probe Sampling", SIGGRAPH 2005
// poster.
#pragma once

#include <cstddef>
#include <vector>

#include "lights/lat_long_grid.h"

namespace relumine::lights {

/// A number of regions that is a power of two comes from cutting every region in each round, as the
/// paper has it; regions of one pixel stay as they are. Any other number, and what such regions
/// leave short, comes from cutting the region with most energy. Cuts divide the energy as evenly as
/// columns or rows allow. O(pixels) for the table, then O(log pixels) per region.
[[nodiscard]] std::vector<PixelRectangle> median_cut(const LatLongGrid& grid,
                                                     std::size_t num_regions);

} // namespace relumine::lights
