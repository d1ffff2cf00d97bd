// Environment images from one layout to another: turned as asked, with the energy of every pixel
// kept.
#pragma once

#include <glm/mat3x3.hpp>

#include "cubemap/image/environment.h"
#include "cubemap/image/image_layout.h"

namespace relumine::cubemap {

/// From the directions of an image to those of another: both have axes of their own in the world.
struct Reorientation {
    /// Carries axes to axes
    glm::dmat3 world_from_source = glm::dmat3(1.0);
    /// Then turned about the world's +Y, as rotated() does
    double degrees_about_y = 0.0;
    /// Carries axes to axes
    glm::dmat3 world_from_target = glm::dmat3(1.0);

    [[nodiscard]] glm::dmat3 target_from_source() const;
    [[nodiscard]] Reorientation inverse() const;
};

/// The image in another layout, size and sampling.
///
/// - Where each target pixel shows one source pixel (the faces of a cube in another arrangement, a
/// lat-long turned by whole pixels) pixels
///   are copied bit by bit.
/// - What shrinks is averaged over area: each target pixel is the mean of the source's footprints
/// under it.
/// - What grows (in natural resolution) is interpolated smoothly across all seams and then
/// corrected, so that the mean over each source pixel's footprint is nearly
///   that pixel again and shrinking it back gives the source: with samples never negative,
///   constants constant, total power kept.
///
/// Bitwise independent of the thread count. Throws std::invalid_argument for sizes that do not fit
/// the layout.
[[nodiscard]] EnvironmentImage convert(const EnvironmentImage& image, const ImageShape& target,
                                       const Reorientation& reorientation = {});

/// The size of a converted image whose size nobody asked for: as fine as the image, but at least as
/// fine as 6 x 256 x 256, and where the image is a disc, as 6 x 512 x 512 (to octahedral maps:
/// 640). In smaller maps a pixel is so wide that a sun in it would move when the sphere is cut up
/// differently; with that much room it comes back where it was. Copies keep their size.
[[nodiscard]] ImageSize conversion_size(const EnvironmentImage& image, Layout target);

} // namespace relumine::cubemap
