// The environment with the lights that stand for it, as in [D05] Fig. 1.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/environment.h"
#include "lights/place_lights.h"

namespace relumine::lights {

/// Linear colours in [0, 1], [height * width] row by row from the top.
struct LatLongPicture {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<glm::vec3> pixels;
};

/// The lat-long tone-mapped (Reinhard's global operator), between 1024 and 2048 pixels wide where whole multiples of its own size allow, the
/// regions' borders as thin lines and every light as a small disc in its own colour with a dark ring.
/// Throws std::invalid_argument for images that LatLongGrid refuses.
[[nodiscard]] LatLongPicture region_picture(const cubemap::EnvironmentImage& lat_long,
                                            const Placement& placement);

} // namespace relumine::lights
