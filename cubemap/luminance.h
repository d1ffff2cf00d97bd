// Luminance of a colour.
#pragma once

#include <glm/vec3.hpp>

namespace relumine::cubemap {

/// Returns the luminance of linear RGB with Rec. 709 weights.
[[nodiscard]] inline double luminance(const glm::dvec3& radiance) {
    return 0.2126 * radiance.x + 0.7152 * radiance.y + 0.0722 * radiance.z;
}

} // namespace relumine::cubemap
