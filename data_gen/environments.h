// Environments with known answers, made from nothing: cube maps of any face resolution R, 1 <= R <=
// 16384 (std::invalid_argument otherwise). Every texel is the mean over its solid angle, so that
// energy does not depend on R.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "data_gen/daylight.h"

namespace relumine::data_gen {

/// The same radiance from everywhere: total power 4 pi L, irradiance pi L on any unshadowed
/// surface.
[[nodiscard]] cubemap::CubeMap constant(std::uint32_t resolution,
                                        const glm::vec3& radiance = glm::vec3(1.0f));

/// One round light in the dark, `radiance` within `angular_radius_degrees` (0 < a <= 90) of
/// `direction` (any length but zero). Total power 2 pi L (1 - cos a), to 0.1 % for any R, any place
/// (across edges and corners of faces) and any size, far below a texel's too; irradiance of a
/// surface facing it pi L sin(a)^2, as well as R resolves directions (0.1 % from R = 128 on). A
/// texel at the rim gets its covered part of L.
[[nodiscard]] cubemap::CubeMap disc_light(std::uint32_t resolution, const glm::dvec3& direction,
                                          double angular_radius_degrees,
                                          const glm::vec3& radiance = glm::vec3(1.0f));

/// Adds such a disc to what is in the map.
void add_disc(cubemap::CubeMap& map, const glm::dvec3& direction, double angular_radius_degrees,
              const glm::vec3& radiance);

/// A rectangular light far away, upright: its picture on the plane that touches the unit sphere at
/// `direction` is 2 half_width by 2 half_height (tangents of angles), full radiance inside and a
/// smooth fall to zero over the outer `edge`.
struct SoftBox {
    /// To its centre, any length but zero
    glm::dvec3 direction{0.0, 0.0, 1.0};
    double half_width = 0.4;
    double half_height = 0.4;
    /// Width of the fall, 0 < edge <= the smaller half side
    double edge = 0.1;
    glm::vec3 radiance{1.0f};
};

/// Boxes over a background of constant radiance; where boxes overlap they add up.
[[nodiscard]] cubemap::CubeMap soft_boxes(std::uint32_t resolution, std::span<const SoftBox> boxes,
                                          const glm::vec3& background);

/// A photographer's studio: a large warm key from the front left above, a cool fill from the right,
/// a dim background. A white floor facing up gets about 1 back (irradiance about pi).
[[nodiscard]] cubemap::CubeMap two_soft_boxes(std::uint32_t resolution);

/// Clear sky, sun disc and ground of Daylight (see there for the model and the unit).
[[nodiscard]] cubemap::CubeMap sun_and_sky(std::uint32_t resolution,
                                           const DaylightOptions& options = {});

/// One row of the list of environments.
struct Environment {
    std::string_view name;
    /// One line
    std::string_view description;
    cubemap::CubeMap (*make)(std::uint32_t resolution);
};

/// All environments, in the order to show them: `sun_sky`, `soft_boxes`, `small_light`, `constant`.
/// They are scaled so that a white floor shows well in a picture without further exposure.
[[nodiscard]] std::span<const Environment> environments();

} // namespace relumine::data_gen
