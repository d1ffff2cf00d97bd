#include "prt/receivers/camera.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "prt/visibility/ray_scene.h"

namespace relumine::prt {

CameraAxes axes_of(const Camera& camera, float aspect) {
    constexpr float RadiansPerDegree = std::numbers::pi_v<float> / 180.0f;
    for (const glm::vec3& point : {camera.eye, camera.target})
        for (int axis = 0; axis < 3; ++axis)
            if (!(std::abs(point[axis]) < LargestCoordinate))
                throw std::invalid_argument(
                    fmt::format("expected a camera within {} of the origin, got {}",
                                LargestCoordinate, point[axis]));
    if (!std::isfinite(camera.roll_degrees))
        throw std::invalid_argument("expected a finite roll of a camera");
    const glm::vec3 to_target = camera.target - camera.eye;
    if (!(glm::length(to_target) > 0.0f) || !std::isfinite(glm::length(to_target)))
        throw std::invalid_argument("expected a camera target apart from its eye");
    if (!(camera.fov_degrees > 0.0f && camera.fov_degrees < 180.0f))
        throw std::invalid_argument(fmt::format(
            "expected a field of view between 0 and 180 degrees, got {}", camera.fov_degrees));
    const glm::vec3 forward = glm::normalize(to_target);
    const auto [right, up] = mesh::rolled_axes(forward, camera.roll_degrees);
    const float half_height = std::tan(0.5f * camera.fov_degrees * RadiansPerDegree);
    return {.right = right * half_height * aspect, .up = up * half_height, .forward = forward};
}

PictureRays::PictureRays(const Camera& camera, std::uint32_t width, std::uint32_t height,
                         std::uint32_t samples_per_axis)
    : samples_per_axis_(samples_per_axis) {
    const auto is_size = [](std::uint32_t size) {
        return size >= 1 && size <= MaxPictureSize;
    };
    if (!is_size(width) || !is_size(height))
        throw std::invalid_argument(
            fmt::format("expected a picture of 1 to {} pixels a side, got {} x {}", MaxPictureSize,
                        width, height));
    if (samples_per_axis < 1 || samples_per_axis > MaxSamplesPerAxis)
        throw std::invalid_argument(
            fmt::format("expected 1 to {} samples a side of a pixel, got {}", MaxSamplesPerAxis,
                        samples_per_axis));
    const CameraAxes axes = axes_of(camera, static_cast<float>(width) / static_cast<float>(height));
    forward_ = axes.forward;
    corner_ = axes.forward - axes.right + axes.up;
    right_ = 2.0f / static_cast<float>(width) * axes.right;
    down_ = -2.0f / static_cast<float>(height) * axes.up;
    for (std::uint32_t row = 0; row < samples_per_axis; ++row)
        for (std::uint32_t column = 0; column < samples_per_axis; ++column)
            places_.push_back((glm::vec2(column, row) + 0.5f) /
                              static_cast<float>(samples_per_axis));
}

glm::vec3 PictureRays::direction(std::uint32_t x, std::uint32_t y, std::uint32_t i) const {
    return direction(glm::vec2(x, y) + places_[i]);
}

glm::vec3 PictureRays::direction(const glm::vec2& place) const {
    return glm::normalize(corner_ + place.x * right_ + place.y * down_);
}

} // namespace relumine::prt
