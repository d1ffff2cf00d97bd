#include "relumine/out/level_camera.h"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace relumine {

mesh::Camera leveled(const mesh::Camera& camera) {
    constexpr float OffTheLine = 0.01f; // radians, as of viewer::OrbitCamera
    mesh::Camera result = camera;
    const glm::vec3 ahead = camera.target - camera.eye;
    const float distance = glm::length(ahead);
    if (!(distance > 0.0f))
        return result;
    const glm::vec3 forward = ahead / distance;
    if (!(std::abs(forward.y) > std::cos(2.0f * OffTheLine)))
        return result;
    const float side = forward.y < 0.0f ? 1.0f : -1.0f; // the eye is above, or below
    glm::vec3 outwards = -side * mesh::rolled_axes(forward, camera.roll_degrees).up;
    outwards.y = 0.0f;
    outwards = glm::normalize(outwards);
    const glm::vec3 to_eye =
        std::sin(OffTheLine) * outwards + side * std::cos(OffTheLine) * glm::vec3(0.0f, 1.0f, 0.0f);
    result.eye = camera.target + distance * to_eye;
    result.roll_degrees = 0.0f;
    return result;
}

mesh::Camera brought_near(mesh::Camera camera, float most) {
    const glm::vec3 to_eye = camera.eye - camera.target;
    const float distance = glm::length(to_eye);
    if (!(distance > most))
        return camera;
    constexpr float Radians = std::numbers::pi_v<float> / 180.0f;
    camera.eye = camera.target + most / distance * to_eye;
    camera.fov_degrees =
        2.0f / Radians * std::atan(std::tan(0.5f * Radians * camera.fov_degrees) * distance / most);
    return camera;
}

} // namespace relumine
