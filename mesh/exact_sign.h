// Signs of determinants of float points, without rounding errors.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace relumine::mesh {

/// Returns +1 if a, b, c turn to the left, -1 if they turn to the right, 0 if they lie on a line.
/// Exact for all finite floats.
[[nodiscard]] int turn(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c);

/// Returns true if the four points lie in one plane. Exact for all finite floats.
[[nodiscard]] bool coplanar(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
                            const glm::vec3& d);

} // namespace relumine::mesh
