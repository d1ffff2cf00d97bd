// Suns that the camera or the file could not hold. Their light is lost, and with it shadows and
// brightness.
#pragma once

#include <optional>
#include <string>

#include <glm/vec3.hpp>

#include "cubemap/doctor/statistics.h"
#include "cubemap/doctor/sun.h"
#include "cubemap/image/environment.h"

namespace relumine::cubemap {

/// A sun that was probably clipped, and the reason to think so.
struct ClippedSun {
    /// Unit direction to the sun.
    glm::dvec3 direction{0.0, 1.0, 0.0};
    /// The reason in one phrase: "12 adjacent pixels at the map's maximum of 9.7".
    std::string why = {};
};

/// Returns a sun that was probably clipped, judged by what clipping leaves behind:
/// - pixels at the largest half, or infinite pixels (as counted in image.bad_pixels);
/// - four or more adjacent pixels at the map's maximum, in a spot under 10 degrees that is less
///   than 5000 times as bright as its surroundings;
/// - no sun, but a glow in a bright sky: a peak 2.5 to 100 times as bright as its surroundings,
///   which are brighter than the mean;
/// - a sun more than 10 degrees high whose irradiance is under a quarter of the sky's.
///
/// The result is a hint, not a proof: thin clouds change a sun like a clipping camera. `search` and
/// `statistics` belong to the image.
[[nodiscard]] std::optional<ClippedSun> clipped_sun(const EnvironmentImage& image,
                                                    const SunSearch& search,
                                                    const EnvironmentStatistics& statistics);

} // namespace relumine::cubemap
