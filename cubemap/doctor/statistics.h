// What is worth knowing about an environment before it lights anything.
#pragma once

#include <array>

#include <glm/vec3.hpp>

#include "cubemap/image/environment.h"

namespace relumine::cubemap {

/// Figures of an environment image. Sums are solid-angle weighted and in double; bad pixels are
/// left out of all but the counts.
struct EnvironmentStatistics {
    /// Over the sphere, per channel
    glm::dvec3 mean_radiance{0.0};
    /// Rec. 709 weights
    double mean_luminance = 0.0;
    double max_luminance = 0.0;
    /// Smallest luminance above zero, 0 when there is none
    double min_positive_luminance = 0.0;
    /// log2(max / min positive)
    double dynamic_range_ev = 0.0;
    /// Unit; centre of the brightest pixel
    glm::dvec3 brightest_direction{0.0};
    /// Irradiance of unshadowed surfaces that face +X, -X, +Y (up), -Y, +Z, -Z, the order of Face.
    std::array<glm::dvec3, 6> axis_irradiance{};
};

[[nodiscard]] EnvironmentStatistics statistics(const EnvironmentImage& image);

} // namespace relumine::cubemap
