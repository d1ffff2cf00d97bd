// Means over the pixels of one lat-long for the pixels of another that has the same vertical.
#pragma once

#include <glm/mat3x3.hpp>

#include "cubemap/image/environment.h"
#include "cubemap/image/image_layout.h"

namespace relumine::cubemap {

/// Whether a matrix, orthogonal up to rounding, leaves the vertical axis where it is or turns it
/// over. Rows and columns of a lat-long then stay rows and columns.
[[nodiscard]] bool keeps_vertical(const glm::dmat3& turn);

/// Averages a lat-long over the footprint of each pixel of a lat-long of another size. The means
/// are exact: a footprint is a range of longitudes times a range of latitudes.
///
/// `target_from_source` must keep the vertical.
///
/// Cost:  one addition per source pixel and per pixel of a picture with the source's height and the
///        target's width.
[[nodiscard]] EnvironmentImage resize_lat_long(const EnvironmentImage& image,
                                               const ImageShape& target,
                                               const glm::dmat3& target_from_source);

} // namespace relumine::cubemap
