// Regions whose energy lies close together.
// Based on: [VD09] K. Viriyothai, P. Debevec, "Variance Minimization Light Probe Sampling",
// SIGGRAPH 2009 poster.
#pragma once

#include <cstddef>
#include <vector>

#include "lights/lat_long_grid.h"

namespace relumine::lights {

/// The variance of a region r is the sum of L_p d_p^2 over its pixels: energy times squared
/// distance from the region's centroid. A region is cut, across or along, where the variances of
/// the two halves have the smallest sum; one without variance in the middle of its longest
/// dimension.
///
/// On the sphere. d is the distance in space between directions w and the centroid c = M1 / M0,
/// with the moments M0 = sum of E and M1 = sum of E w over the region. Directions have length 1, so
///     variance = sum E |w - c|^2 = sum E - 2 c.M1 + |c|^2 M0 = M0 - |M1|^2 / M0,
/// and one table of four numbers, (M1, M0), gives it for any rectangle. Each pixel is a patch of
/// constant radiance and brings its own extent.
///
/// Differs from [VD09], which works in the image's coordinates and in each round cuts every region
/// where the larger variance of its halves is smallest:
/// - Distances on the sphere: in the image the poles are far from themselves.
/// - The smallest sum: a light at the centroid leaves an error of second order, which is the
/// variance, and the lights' errors add up.
/// - One region at a time, so any number of regions. The next is that of the largest E
/// sqrt(variance) = E^1.5 d, with the energy E = M0
///   and the mean distance d = sqrt(variance / E). A shadow's border falls into the region about as
///   often as d says, and then its light is wrong by about E: the mean square is E^2 d, the mean E
///   d, and this lies between them. (E^2 d itself is as good on most maps and leaves too much in
///   wide regions on some. Always the largest variance, E d^2, spends lights on wide faint
///   regions.)
/// O(pixels) for the table (32 bytes per pixel), then O(width + height) per region.
[[nodiscard]] std::vector<PixelRectangle> variance_cut(const LatLongGrid& grid,
                                                       std::size_t num_regions);

} // namespace relumine::lights
