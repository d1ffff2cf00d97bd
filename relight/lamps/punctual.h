// Lights without a surface: points, spots and directional ones, as KHR_lights_punctual has them,
// and those with a profile.
#pragma once

#include <limits>

#include <glm/vec3.hpp>

#include "mesh/materials/punctual_light.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::relight {

/// What a light gives to a place if nothing is between.
struct Arriving {
    /// Towards the light, of unit length.
    glm::dvec3 direction{0.0};
    double distance = std::numeric_limits<double>::infinity();
    /// Across the beam.
    glm::dvec3 irradiance{0.0};
};

/// Range and cone are those that KHR_lights_punctual recommends.
[[nodiscard]] Arriving arriving(const mesh::PunctualLight& light, const glm::dvec3& place);

/// Returns the radiance, for albedo 1, that a light gives to a receiver: one shadow ray.
[[nodiscard]] glm::dvec3 punctual_light(const mesh::PunctualLight& light, const glm::vec3& origin,
                                        const glm::dvec3& normal, const prt::RayScene& rays);

} // namespace relumine::relight
