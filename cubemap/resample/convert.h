// Conversion of environment images between layouts. The energy of every pixel is kept.
#pragma once

#include <glm/mat3x3.hpp>

#include "cubemap/image/environment.h"
#include "cubemap/image/image_layout.h"

namespace relumine::cubemap {

/// Returns the image in another layout, size and sampling, turned by an orthogonal matrix (mirror
/// images are allowed).
///
/// - Pixels are copied bit by bit where each target pixel shows one source pixel: the faces of a
///   cube in another arrangement, a lat-long turned by whole pixels.
/// - An image that shrinks is averaged over area: each target pixel is the mean of the source's
///   footprints under it.
/// - An image that grows (in natural resolution) is interpolated smoothly across all seams and then
///   corrected: the mean over each source pixel's footprint is nearly that pixel again, so
///   shrinking the image back gives the source. Samples are never negative, constants stay
///   constant, and total power is kept.
///
/// Throws:  std::invalid_argument for sizes that do not fit the layout.
/// Threads: parallel (TBB); the result is bitwise independent of the number of threads.
[[nodiscard]] EnvironmentImage convert(const EnvironmentImage& image, const ImageShape& target,
                                       const glm::dmat3& target_from_source = glm::dmat3(1.0));

/// Returns the size of a converted image for which the user gave no size. The result is as fine as
/// the image, and at least as fine as 6 x 256 x 256. Images of a disc get at least 6 x 512 x 512
/// (octahedral targets: 640).
///
/// The reason for the least size: in a small map a pixel is wide, and a sun in it would move when
/// the sphere is divided in another way. With this much room the sun comes back to its place.
/// Copies keep the size of their source.
[[nodiscard]] ImageSize conversion_size(const EnvironmentImage& image, Layout target);

} // namespace relumine::cubemap
