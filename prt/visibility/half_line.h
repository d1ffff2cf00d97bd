// How far a ray passes a triangle.
#pragma once

#include <array>

#include <glm/vec3.hpp>

namespace relumine::prt {

/// Whether the half-line from the coordinates' origin along the unit vector `w` stays farther than
/// `distance` from a triangle. What lies obliquely behind the start is close up to sqrt(2) times
/// that.
[[nodiscard]] bool passes_by(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& w,
                             double distance);

} // namespace relumine::prt
