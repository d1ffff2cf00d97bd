// Generated environments with known answers: cube maps of any face resolution R.
//
// Every texel is the mean over its solid angle, so energy does not depend on R. Every function
// throws std::invalid_argument unless 1 <= R <= 16384.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "data_gen/daylight.h"

namespace relumine::data_gen {

/// Returns the same radiance L from everywhere. Total power is 4 pi L; irradiance is pi L on any
/// unshadowed surface.
[[nodiscard]] cubemap::CubeMap constant(std::uint32_t resolution,
                                        const glm::vec3& radiance = glm::vec3(1.0f));

/// Returns one round light in the dark: radiance L within `angular_radius_degrees` (0 < a <= 90) of
/// `direction`, which may have any length but zero. A texel at the rim gets its covered part of L.
///
/// Energy:  total power is 2 pi L (1 - cos a) to 0.1 %, for any R, any place (across edges and
///          corners of faces) and any size, also far below a texel's. The irradiance of a surface
///          that faces the light is pi L sin(a)^2, as well as R resolves directions: to 0.1 % from
///          R = 128 on.
[[nodiscard]] cubemap::CubeMap disc_light(std::uint32_t resolution, const glm::dvec3& direction,
                                          double angular_radius_degrees,
                                          const glm::vec3& radiance = glm::vec3(1.0f));

/// Adds such a disc to the light in the map.
void add_disc(cubemap::CubeMap& map, const glm::dvec3& direction, double angular_radius_degrees,
              const glm::vec3& radiance);

/// An upright rectangular light far away. Its picture on the plane that touches the unit sphere at
/// `direction` is 2 half_width by 2 half_height (tangents of angles). It has full radiance inside
/// and falls smoothly to zero over the outer `edge`.
struct SoftBox {
    /// Direction to the centre, of any length but zero.
    glm::dvec3 direction{0.0, 0.0, 1.0};
    double half_width = 0.4;
    double half_height = 0.4;
    /// Width of the fall, 0 < edge <= the smaller half side.
    double edge = 0.1;
    glm::vec3 radiance{1.0f};
};

/// Returns boxes over a background of constant radiance. Boxes that overlap add up.
[[nodiscard]] cubemap::CubeMap soft_boxes(std::uint32_t resolution, std::span<const SoftBox> boxes,
                                          const glm::vec3& background);

/// Returns a photographer's studio: a large warm key light from the front left above, a cool fill
/// light from the right, and a dim background. A white floor facing up reflects about 1 (irradiance
/// about pi).
[[nodiscard]] cubemap::CubeMap two_soft_boxes(std::uint32_t resolution);

/// Returns clear sky, the sun's disc and the ground. Daylight states the model and the unit.
[[nodiscard]] cubemap::CubeMap sun_and_sky(std::uint32_t resolution,
                                           const DaylightOptions& options = {});

/// One row of the list of environments.
struct Environment {
    std::string_view name;
    /// One line.
    std::string_view description;
    cubemap::CubeMap (*make)(std::uint32_t resolution);
};

/// Returns all environments in the order to show them: `sun_sky`, `soft_boxes`, `small_light`,
/// `constant`. With their scale, a white floor shows well in a picture without further exposure.
[[nodiscard]] std::span<const Environment> environments();

} // namespace relumine::data_gen
