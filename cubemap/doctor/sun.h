// The sun of an environment: where it is, how large, how strong, and which pixels it is made of.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/doctor/bright_spot.h"
#include "cubemap/image/environment.h"

namespace relumine::cubemap {

/// A pixel that shows the sun, and what would be seen there without it.
struct SunPixel {
    /// Into the image's or the cube map's pixels
    std::size_t index = 0;
    glm::vec3 sky{
        /// Radiance of the sky around, carried over the sun; no channel above the pixel's own
        0.0f};
};

/// The sun is what its pixels have above the sky around it.
struct Sun {
    /// Unit; the mean direction of its light
    glm::dvec3 direction{0.0, 1.0, 0.0};
    /// RGB, on a surface that faces it
    glm::dvec3 irradiance{0.0};
    /// Of the uniform disc whose light is spread as widely (same variance of directions), a pixel
    /// being a disc of its own solid angle: exact for a sun of one pixel; a sun smaller than a
    /// pixel has the pixel's.
    double solid_angle = 0.0;
    double peak_luminance = 0.0;
    /// Mean over its pixels of what is around it
    double sky_luminance = 0.0;
    /// Of all light (luminance over the sphere), 0 to 1
    double share_of_power = 0.0;
    std::vector<SunPixel> pixels = {};
};

struct SunSearch {
    std::optional<Sun> sun = {};
    /// One phrase, "the brightest light is 12 degrees wide"; empty with a sun
    std::string why_none = {};
    /// Where it was looked for; at most 512 texels along a face's edge
    std::vector<BrightSpot> spots = {};
    /// Of the cube map that the spots' texels belong to
    std::uint32_t spot_resolution = 0;
    /// Luminance over the sphere
    double power = 0.0;
    /// Of the disc as large as the mean pixel
    double pixel_diameter_degrees = 0.0;
};

/// The strongest of the bright spots, if it is a sun: at most 5 degrees wide (or 3 pixels), at
/// least 8 times as bright as its surroundings, half a percent or more of all light, and with no
/// other spot of nearly its strength: rooms have several lamps or windows. Finds it anywhere: over
/// the seam, the edges of faces and at the poles. Radiance must be finite and not negative. Bitwise
/// independent of the thread count.
[[nodiscard]] SunSearch find_sun(const EnvironmentImage& image);
[[nodiscard]] SunSearch find_sun(const CubeMap& map);

} // namespace relumine::cubemap
