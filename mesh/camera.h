// A camera, as files have it and pictures are seen from it.
#pragma once

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace relumine::mesh {

/// A pinhole camera. Without a roll its picture is level, +Y up.
struct Camera {
    glm::vec3 eye{0.0f};
    glm::vec3 target{0.0f};
    /// Vertical field of view.
    float fov_degrees = 35.0f;
    /// Turns the camera about its view, counter-clockwise as seen from behind it.
    float roll_degrees = 0.0f;
    bool operator==(const Camera&) const = default;
};

/// The directions to the right and upwards in a picture, of unit length.
struct PictureAxes {
    glm::vec3 right, up;
};

/// Returns the axes of a level camera that looks along a unit vector. One that looks straight up or
/// down has -Z as its picture's up.
[[nodiscard]] inline PictureAxes level_axes(const glm::vec3& forward) {
    const glm::vec3 world_up =
        std::abs(forward.y) < 0.9999f ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, -1);
    const glm::vec3 right = glm::normalize(glm::cross(forward, world_up));
    return {.right = right, .up = glm::cross(right, forward)};
}

/// Returns the axes of a camera that looks along a unit vector.
[[nodiscard]] inline PictureAxes rolled_axes(const glm::vec3& forward, float roll_degrees) {
    const PictureAxes level = level_axes(forward);
    if (roll_degrees == 0.0f)
        return level;
    const float roll = roll_degrees * std::numbers::pi_v<float> / 180.0f;
    return {.right = std::cos(roll) * level.right + std::sin(roll) * level.up,
            .up = std::cos(roll) * level.up - std::sin(roll) * level.right};
}

/// Returns the roll of a camera that looks along a unit vector and has this direction upwards in
/// its picture. A hundredth of a degree is a rounding.
[[nodiscard]] inline float roll_of(const glm::vec3& forward, const glm::vec3& up) {
    const PictureAxes level = level_axes(forward);
    const float degrees = std::atan2(-glm::dot(up, level.right), glm::dot(up, level.up)) * 180.0f /
                          std::numbers::pi_v<float>;
    return std::abs(degrees) < 0.01f ? 0.0f : degrees;
}

} // namespace relumine::mesh
