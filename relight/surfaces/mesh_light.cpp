#include "relight/surfaces/mesh_light.h"

#include <glm/geometric.hpp>

namespace relumine::relight {

float FadingFloor::opacity(const glm::vec3& position) const {
    const float radius = glm::distance(glm::vec2(position.x, position.z), center);
    if (radius <= opaque_radius)
        return 1.0f;
    if (radius >= end_radius)
        return 0.0f;
    const float t = (end_radius - radius) / (end_radius - opaque_radius);
    return t * t * (3.0f - 2.0f * t);
}

glm::vec3 caught(const glm::vec3& radiance, const glm::vec3& open, float opacity) {
    glm::vec3 result(1.0f);
    for (int channel = 0; channel < 3; ++channel)
        if (open[channel] > 0.0f)
            result[channel] += opacity * (radiance[channel] / open[channel] - 1.0f);
    return result;
}

} // namespace relumine::relight
