#include "relight/surfaces/visible_normals.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace relumine::relight {

glm::vec3 visible_half(const glm::vec3& to_eye, float alpha, const glm::vec2& u) {
    const glm::vec3 v = glm::normalize(glm::vec3(alpha * to_eye.x, alpha * to_eye.y, to_eye.z));
    const float length2 = v.x * v.x + v.y * v.y;
    const glm::vec3 t1 = length2 > 0.0f ? glm::vec3(-v.y, v.x, 0.0f) / std::sqrt(length2)
                                        : glm::vec3(1.0f, 0.0f, 0.0f);
    const glm::vec3 t2 = glm::cross(v, t1);
    const float r = std::sqrt(u.x);
    const float phi = 2.0f * std::numbers::pi_v<float> * u.y;
    const float x = r * std::cos(phi);
    const float s = 0.5f * (1.0f + v.z);
    const float y = (1.0f - s) * std::sqrt(std::max(1.0f - x * x, 0.0f)) + s * r * std::sin(phi);
    const glm::vec3 h = x * t1 + y * t2 + std::sqrt(std::max(1.0f - x * x - y * y, 0.0f)) * v;
    return glm::normalize(glm::vec3(alpha * h.x, alpha * h.y, std::max(h.z, 1e-6f)));
}

float mirrored_density(const glm::vec3& half, float n_v, float alpha) {
    const float a2 = alpha * alpha;
    const float d = half.x * half.x + half.y * half.y + a2 * half.z * half.z;
    const float mask = n_v + std::sqrt(n_v * n_v * (1.0f - a2) + a2);
    return a2 / (std::numbers::pi_v<float> * d * d) * 0.5f / mask;
}

} // namespace relumine::relight
