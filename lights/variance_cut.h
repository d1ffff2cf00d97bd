// Regions whose energy lies close together.
// Based on: [VD09] K. Viriyothai, P. Debevec, "Variance Minimization Light Probe Sampling", SIGGRAPH 2009 poster.
#pragma once

#include <cstddef>
#include <vector>

#include "lights/lat_long_grid.h"

namespace relumine::lights {

/// The variance of a region r is the sum of L_p d_p^2 over its pixels: energy times squared distance from the region's centroid. The region of
/// largest variance is cut next, across or along, where the variances of the two halves have the smallest sum; one without
/// variance in the middle of its longest dimension.
///
/// On the sphere. d is the distance in space between directions w and the centroid c = M1 / M0, with the moments M0 = sum of E and
/// M1 = sum of E w over the region. Directions have length 1, so
///     variance = sum E |w - c|^2 = sum E - 2 c.M1 + |c|^2 M0 = M0 - |M1|^2 / M0,
/// and one table of four numbers, (M1, M0), gives it for any rectangle. Each pixel is a patch of constant radiance and brings its own
/// extent.
///
/// Differs from [VD09]: distances on the sphere, not in the image, where the poles are far from themselves; the smallest sum of the halves'
/// variances, not the smallest maximum: a light at the centroid leaves an error of second order, which is the variance, and the errors of
/// all lights add up; any number of regions.
/// O(pixels) for the table (32 bytes per pixel), then O(width + height) per region.
[[nodiscard]] std::vector<PixelRectangle> variance_cut(const LatLongGrid& grid, std::size_t num_regions);

} // namespace relumine::lights
