// Suns that the camera or the file could not hold: their light is lost, and with it shadows and
// brightness.
#pragma once

#include <optional>
#include <string>

#include <glm/vec3.hpp>

#include "cubemap/doctor/statistics.h"
#include "cubemap/doctor/sun.h"
#include "cubemap/image/environment.h"

namespace relumine::cubemap {

struct ClippedSun {
    /// Unit; where it is
    glm::dvec3 direction{0.0, 1.0, 0.0};
    /// One phrase: "12 adjacent pixels at the map's maximum of 9.7"
    std::string why = {};
};

/// A sun that was likely clipped, from what it leaves behind:
/// - pixels at the largest half, or infinite ones (as image.bad_pixels counted them);
/// - four adjacent pixels or more at the map's maximum, in a spot under 10 degrees that is not 5000
/// times its surroundings as a sun is;
/// - no sun, but a glow in a bright sky: a peak 2.5 to 100 times what is around it, which itself is
/// brighter than the mean;
/// - a sun more than 10 degrees high whose irradiance is under a quarter of the sky's.
/// A hint and no proof: thin clouds do the same to a sun as a clipping camera. `search` and
/// `statistics` are the image's.
[[nodiscard]] std::optional<ClippedSun> clipped_sun(const EnvironmentImage& image,
                                                    const SunSearch& search,
                                                    const EnvironmentStatistics& statistics);

} // namespace relumine::cubemap
