// Signs of determinants of float points, free of rounding.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace relumine::mesh {

/// +1 where a, b, c turn to the left, -1 to the right, 0 where they lie on a line. Exact for all
/// finite floats.
[[nodiscard]] int turn(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c);

/// Whether the four points lie in one plane. Exact for all finite floats.
[[nodiscard]] bool coplanar(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
                            const glm::vec3& d);

} // namespace relumine::mesh
