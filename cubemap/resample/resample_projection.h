// Converts pictures of a Projection to cube maps from exact overlaps. Called by resample().
#pragma once

#include <cstdint>

#include "cubemap/cube_map.h"
#include "cubemap/image/environment.h"

namespace relumine::cubemap::detail {

/// Returns a picture of a Projection as a cube map.
[[nodiscard]] CubeMap cube_from_projection(const EnvironmentImage& image, std::uint32_t resolution);

} // namespace relumine::cubemap::detail
