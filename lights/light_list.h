// A few distant lights that stand for an environment.
#pragma once

#include <vector>

#include <glm/vec3.hpp>

namespace relumine::lights {

/// A light so far away that its direction is the same for the whole scene.
struct DistantLight {
    /// Unit, from the scene to the light.
    glm::dvec3 direction{0.0, 1.0, 0.0};
    /// RGB irradiance on a surface that faces the light: radiance times solid angle.
    glm::dvec3 irradiance{0.0};
    /// Solid angle of the part of the sphere that the light stands for, in steradians. 0: a point.
    double solid_angle = 0.0;
};

/// Returns the sum of the lights' irradiance, each on a surface that faces the light. For lights of
/// an environment this is the power of the map.
[[nodiscard]] glm::dvec3 total_irradiance(const std::vector<DistantLight>& lights);

} // namespace relumine::lights
