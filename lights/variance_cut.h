// Cuts a lat-long into regions whose energy lies close together.
// Based on: [VD09] K. Viriyothai, P. Debevec, "Variance Minimization Light Probe Sampling",
// SIGGRAPH 2009 poster.
#pragma once

#include <cstddef>
#include <vector>

#include "lights/lat_long_grid.h"

namespace relumine::lights {

/// Returns `num_regions` regions of small variance. The variance of a region r is the sum of E_p
/// d_p^2 over its pixels: energy times squared distance from the region's centroid. A region is
/// cut, across or along, where the sum of its halves' variances is smallest. A region without
/// variance is cut in the middle of its longest dimension.
///
/// On the sphere, d is the distance in space between a direction w and the centroid c = M1 / M0,
/// with the moments M0 = sum of E and M1 = sum of E w over the region. Directions have length 1, so
///     variance = sum E |w - c|^2 = sum E - 2 c.M1 + |c|^2 M0 = M0 - |M1|^2 / M0.
/// One table of the four numbers (M1, M0) gives the variance of any rectangle. Each pixel is a
/// patch of constant radiance and has its own extent.
///
/// Differs from [VD09], which works in the image's coordinates, cuts where the larger variance of
/// the two halves is smallest, and cuts every region in each round:
/// - Distances are on the sphere. In the image a pole would be far from itself.
/// - The sum of variances is minimised. A light at the centroid leaves an error of second order,
///   the variance, and the lights' errors add up.
/// - One region is cut at a time, so any number of regions is possible. The next region has the
///   largest E sqrt(variance) = E^1.5 d, with energy E = M0 and mean distance d = sqrt(variance /
///   E).
///
/// Why E^1.5 d: a shadow's border falls into a region with a frequency of about d, and the region's
/// light is then wrong by about E. The mean square error is E^2 d, the mean error E d, and E^1.5 d
/// lies between them. E^2 d itself is as good on most maps, but leaves too much in wide regions on
/// some. The largest variance, E d^2, spends lights on wide faint regions.
///
/// Cost:    O(pixels) for the table (32 bytes per pixel), then O(width + height) per region.
[[nodiscard]] std::vector<PixelRectangle> variance_cut(const LatLongGrid& grid,
                                                       std::size_t num_regions);

} // namespace relumine::lights
