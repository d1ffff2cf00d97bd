// Between image layouts and cube maps, keeping the energy of every pixel.
#pragma once

#include "cubemap/cube_map.h"
#include "cubemap/image/environment.h"

namespace relumine::cubemap {

/// The image as a cube map of 6 x R x R. Each pixel is a footprint of constant radiance on the
/// sphere; each texel becomes the mean over its solid angle, from the exact overlaps of footprints
/// and texels. So total power is kept to rounding, constants stay constant, and the irradiance of a
/// one-pixel sun is kept as well as the texel size allows. A cube image of the same resolution
/// sampled at texel centres is copied bit by bit. Bitwise independent of the thread count.
[[nodiscard]] CubeMap resample(const EnvironmentImage& image, std::uint32_t resolution);

/// A cube map at another resolution, in the same way.
[[nodiscard]] CubeMap resample(const CubeMap& map, std::uint32_t resolution);

/// The other way round: a cube map as an image of the given layout, size and sampling; each pixel
/// is the mean over its footprint.
[[nodiscard]] EnvironmentImage to_image(const CubeMap& map, Layout layout, std::uint32_t width,
                                        std::uint32_t height,
                                        Sampling sampling = Sampling::TexelCentres);

} // namespace relumine::cubemap
