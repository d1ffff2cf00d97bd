// The luminance that lights are placed by.
#pragma once

#include <glm/vec3.hpp>

namespace relumine::lights {

/// Luminance of linear RGB with the weights that [D05] takes from ITU-R BT.709.
[[nodiscard]] inline double luminance(const glm::dvec3& rgb) {
    return 0.2125 * rgb.r + 0.7154 * rgb.g + 0.0721 * rgb.b;
}

} // namespace relumine::lights
