// Directions as people say them: azimuth and elevation.
#pragma once

#include <glm/vec3.hpp>

namespace relumine::cubemap {

/// Elevation above the horizon: 0 on it, 90 at +Y, -90 at -Y. Azimuth about +Y from +Z towards +X:
/// 0 at +Z, 90 at +X, 180 at -Z, -90 at -X; in (-180, 180], and 0 at the poles. The direction is
/// (sin a cos e, sin e, cos a cos e). A lat-long's column has the azimuth 180 - 360 x / width.
struct SkyAngles {
    double elevation_degrees = 0.0;
    double azimuth_degrees = 0.0;
};

/// The angles of a direction of any length but zero.
[[nodiscard]] SkyAngles sky_angles(const glm::dvec3& direction);

/// The unit direction of angles.
[[nodiscard]] glm::dvec3 direction(const SkyAngles& angles);

/// Angular diameter in degrees of the disc on the sphere that has this solid angle, 0 to 4 pi
/// steradians.
[[nodiscard]] double disc_diameter_degrees(double solid_angle);

} // namespace relumine::cubemap
