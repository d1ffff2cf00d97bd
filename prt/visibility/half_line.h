// Where a ray meets a triangle, and how far it passes one.
#pragma once

#include <array>
#include <limits>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace relumine::prt {

/// Whether a half-line meets a triangle. The half-line goes from the coordinates' origin along `w`,
/// of any length.
[[nodiscard]] bool meets(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& w);

/// Where a half-line meets a triangle.
struct Meeting {
    /// In units of the direction's length
    double distance = std::numeric_limits<double>::infinity();
    /// Weights of the second and third corner
    glm::dvec2 barycentric{0.0};
};

/// Returns where a half-line like that of meets() meets a triangle. One within the triangle's plane
/// meets its first corner.
[[nodiscard]] Meeting meeting_of(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& w);

/// Whether a half-line stays farther than `distance` from a triangle. The half-line goes from the
/// coordinates' origin along the unit vector `w`. A point obliquely behind the start counts as
/// close up to sqrt(2) times `distance`.
[[nodiscard]] bool passes_by(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& w,
                             double distance);

} // namespace relumine::prt
