// Converts pictures of a Projection to cube maps and back from exact overlaps. Called by resample()
// and to_image().
#pragma once

#include <cstdint>

#include "cubemap/cube_map.h"
#include "cubemap/image/environment.h"

namespace relumine::cubemap::detail {

/// Returns a picture of a Projection as a cube map.
[[nodiscard]] CubeMap cube_from_projection(const EnvironmentImage& image, std::uint32_t resolution);

/// Fills the pixels of an image whose layout and size are set. Pixels that show nothing are black.
void fill_projection(const CubeMap& map, EnvironmentImage& image);

} // namespace relumine::cubemap::detail
