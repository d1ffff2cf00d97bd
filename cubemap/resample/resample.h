// Resampling between image layouts and cube maps. The energy of every pixel is kept.
#pragma once

#include "cubemap/cube_map.h"
#include "cubemap/image/environment.h"

namespace relumine::cubemap {

/// Returns the image as a cube map of 6 x R x R. Each pixel is a footprint of constant radiance on
/// the sphere. Each texel is the mean over its solid angle, from the exact overlaps of footprints
/// and texels.
///
/// Energy:  total power is kept to rounding, and constants stay constant. The irradiance of a
///          one-pixel sun is kept as well as the texel size allows. A cube image of the same
///          resolution sampled at texel centres is copied bit by bit.
/// Threads: parallel (TBB); the result is bitwise independent of the number of threads.
[[nodiscard]] CubeMap resample(const EnvironmentImage& image, std::uint32_t resolution);

/// Returns a cube map at another resolution, resampled in the same way.
[[nodiscard]] CubeMap resample(const CubeMap& map, std::uint32_t resolution);

/// Returns a cube map as an image of the given layout, size and sampling. Each pixel is the mean
/// over its footprint.
[[nodiscard]] EnvironmentImage to_image(const CubeMap& map, Layout layout, std::uint32_t width,
                                        std::uint32_t height,
                                        Sampling sampling = Sampling::TexelCentres);

} // namespace relumine::cubemap
