#include "cubemap/doctor/sky_angles.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace relumine::cubemap {

namespace {

constexpr double DegreesPerRadian = 180.0 / std::numbers::pi;

} // namespace

SkyAngles sky_angles(const glm::dvec3& direction) {
    const double across = std::hypot(direction.x, direction.z);
    if (across == 0.0)
        return {.elevation_degrees = direction.y < 0.0 ? -90.0 : 90.0};
    const double azimuth = std::atan2(direction.x, direction.z) * DegreesPerRadian;
    return {.elevation_degrees = std::atan2(direction.y, across) * DegreesPerRadian,
            .azimuth_degrees = azimuth <= -180.0 ? 180.0 : azimuth};
}

glm::dvec3 direction(const SkyAngles& angles) {
    const double elevation = angles.elevation_degrees / DegreesPerRadian;
    const double azimuth = angles.azimuth_degrees / DegreesPerRadian;
    return {std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
            std::cos(azimuth) * std::cos(elevation)};
}

double disc_diameter_degrees(double solid_angle) {
    // The solid angle of a cap of angular radius a is 2 pi (1 - cos a) = 4 pi sin^2(a / 2). The
    // second form has no cancellation for small caps.
    const double share = std::clamp(solid_angle / (4.0 * std::numbers::pi), 0.0, 1.0);
    return 4.0 * std::asin(std::sqrt(share)) * DegreesPerRadian;
}

} // namespace relumine::cubemap
