// Cuts a lat-long into regions of equal energy.
// Based on: [D05] P. Debevec, "A Median Cut Algorithm for Light Probe Sampling", SIGGRAPH 2005
// poster.
#pragma once

#include <cstddef>
#include <vector>

#include "lights/lat_long_grid.h"

namespace relumine::lights {

/// Returns `num_regions` regions. For a power of two, each round cuts every region, as in the
/// paper; regions of one pixel stay as they are. For any other number, and for regions still
/// missing then, the region with the most energy is cut next. Cuts divide the energy as evenly as
/// columns or rows allow.
///
/// Cost:    O(pixels) for the table, then O(log pixels) per region.
[[nodiscard]] std::vector<PixelRectangle> median_cut(const LatLongGrid& grid,
                                                     std::size_t num_regions);

} // namespace relumine::lights
