// Figures about an environment that are worth knowing before it lights a scene.
#pragma once

#include <array>

#include <glm/vec3.hpp>

#include "cubemap/image/environment.h"

namespace relumine::cubemap {

/// Figures of an environment image. Sums are weighted by solid angle and in double. Only the counts
/// include bad pixels.
struct EnvironmentStatistics {
    /// Mean over the sphere, per channel.
    glm::dvec3 mean_radiance{0.0};
    /// Luminance has Rec. 709 weights, here and below.
    double mean_luminance = 0.0;
    double max_luminance = 0.0;
    /// Smallest luminance above zero. 0: there is none.
    double min_positive_luminance = 0.0;
    /// log2(max / min positive), in stops.
    double dynamic_range_ev = 0.0;
    /// Unit direction of the brightest pixel's centre.
    glm::dvec3 brightest_direction{0.0};
    /// Irradiance of unshadowed surfaces that face +X, -X, +Y (up), -Y, +Z, -Z: the order of Face.
    std::array<glm::dvec3, 6> axis_irradiance{};
    /// Share of the light (luminance) from below the horizon, 0 to 1.
    double light_from_below = 0.0;
};

/// Computes the figures of an image.
[[nodiscard]] EnvironmentStatistics statistics(const EnvironmentImage& image);

} // namespace relumine::cubemap
