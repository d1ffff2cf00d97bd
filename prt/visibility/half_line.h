// How far a ray passes a triangle.
#pragma once

#include <array>

#include <glm/vec3.hpp>

namespace relumine::prt {

/// Whether a half-line meets a triangle. The half-line goes from the coordinates' origin along `w`,
/// of any length.
[[nodiscard]] bool meets(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& w);

/// Whether a half-line stays farther than `distance` from a triangle. The half-line goes from the
/// coordinates' origin along the unit vector `w`. A point obliquely behind the start counts as
/// close up to sqrt(2) times `distance`.
[[nodiscard]] bool passes_by(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& w,
                             double distance);

} // namespace relumine::prt
