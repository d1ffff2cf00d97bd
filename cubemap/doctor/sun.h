// The sun of an environment: its place, size, strength and pixels.
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

/// A pixel that shows the sun, and the sky that would be seen there without it.
struct SunPixel {
    /// Index of the pixel in the image or the cube map.
    std::size_t index = 0;
    /// Radiance of the surrounding sky, carried over the sun. No channel exceeds the pixel's own.
    glm::vec3 sky{0.0f};
};

/// The sun: the light of its pixels above the sky around it.
struct Sun {
    /// Unit; the mean direction of the sun's light.
    glm::dvec3 direction{0.0, 1.0, 0.0};
    /// RGB irradiance on a surface that faces the sun.
    glm::dvec3 irradiance{0.0};
    /// Solid angle of the uniform disc whose light is spread as widely (same variance of
    /// directions). A pixel counts as a disc of its own solid angle, so a sun of one pixel is
    /// exact; a sun smaller than a pixel gets the pixel's solid angle.
    double solid_angle = 0.0;
    double peak_luminance = 0.0;
    /// Mean over the sun's pixels of the sky's luminance.
    double sky_luminance = 0.0;
    /// The sun's share of all light (luminance over the sphere), 0 to 1.
    double share_of_power = 0.0;
    std::vector<SunPixel> pixels = {};
};

/// The result of a search for the sun: the sun or the reason why there is none, and the lights that
/// were compared.
struct SunSearch {
    std::optional<Sun> sun = {};
    /// Why no sun was found, in one phrase: "the brightest light is 12 degrees wide". Empty: there
    /// is a sun.
    std::string why_none = {};
    /// The spots among which the sun was searched, on a map of at most 512 texels along a face's
    /// edge.
    std::vector<BrightSpot> spots = {};
    /// Resolution of the cube map to which the spots' texels belong.
    std::uint32_t spot_resolution = 0;
    /// Integral of luminance over the sphere.
    double power = 0.0;
    /// Diameter of a disc with the solid angle of the mean pixel.
    double pixel_diameter_degrees = 0.0;
};

/// Finds the sun: the strongest bright spot, under these conditions.
/// - It is at most 5 degrees wide, or 3 pixels.
/// - It is at least 8 times as bright as its surroundings.
/// - It has at least half a percent of all light.
/// - No other spot is nearly as strong: rooms have several lamps or windows.
///
/// The sun is found anywhere: over the seam, over the edges of faces and at the poles. Radiance
/// must be finite and not negative. The result is bitwise independent of the number of threads.
[[nodiscard]] SunSearch find_sun(const EnvironmentImage& image);
[[nodiscard]] SunSearch find_sun(const CubeMap& map);

} // namespace relumine::cubemap
