// Lat-long image to cube map, from exact overlaps. Called through resample().
#pragma once

#include "cubemap/cube_map.h"
#include "cubemap/environment.h"

namespace relumine::cubemap::detail {

[[nodiscard]] CubeMap cube_from_lat_long(const EnvironmentImage& image, std::uint32_t resolution);

} // namespace relumine::cubemap::detail
