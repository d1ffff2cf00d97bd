// Directions as people say them: azimuth and elevation.
#pragma once

#include <glm/vec3.hpp>

namespace relumine::cubemap {

/// Elevation is the angle above the horizon: 0 on it, 90 at +Y, -90 at -Y. Azimuth turns about +Y
/// from +Z towards +X: 0 at +Z, 90 at +X, 180 at -Z, -90 at -X. It lies in (-180, 180] and is 0 at
/// the poles.
///
/// The direction is (sin a cos e, sin e, cos a cos e). Column x of a lat-long has the azimuth 180 -
/// 360 x / width.
struct SkyAngles {
    double elevation_degrees = 0.0;
    double azimuth_degrees = 0.0;
};

/// Returns the angles of a direction of any length but zero.
[[nodiscard]] SkyAngles sky_angles(const glm::dvec3& direction);

/// Returns the unit direction of angles.
[[nodiscard]] glm::dvec3 direction(const SkyAngles& angles);

/// Returns the angular diameter in degrees of a disc on the sphere with this solid angle, 0 to 4 pi
/// steradians.
[[nodiscard]] double disc_diameter_degrees(double solid_angle);

} // namespace relumine::cubemap
