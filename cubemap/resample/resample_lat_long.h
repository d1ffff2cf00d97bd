// Converts a lat-long image to a cube map from exact overlaps. Called by resample().
#pragma once

#include "cubemap/cube_map.h"
#include "cubemap/image/environment.h"

namespace relumine::cubemap::detail {

/// Returns a lat-long image as a cube map. Sampling::Borders makes the outermost texels half as
/// wide as the others, as in a cube with samples on the borders.
[[nodiscard]] CubeMap cube_from_lat_long(const EnvironmentImage& image, std::uint32_t resolution,
                                         Sampling sampling = Sampling::TexelCentres);

} // namespace relumine::cubemap::detail
