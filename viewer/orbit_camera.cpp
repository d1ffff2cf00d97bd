#include "viewer/orbit_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>

#include "relumine/out/level_camera.h"

namespace relumine::viewer {

namespace {

constexpr float QuarterTurn = 0.5f * std::numbers::pi_v<float>;
/// Straight above, "up" has no meaning; this much short of it, "up" still has one.
constexpr float MaxPitch = QuarterTurn - 0.01f;

float radians(float degrees) {
    return degrees * std::numbers::pi_v<float> / 180.0f;
}

float aspect(const PixelRectangle& viewport) {
    return static_cast<float>(std::max(viewport.width, 1)) /
           static_cast<float>(std::max(viewport.height, 1));
}

} // namespace

glm::vec3 OrbitCamera::eye() const {
    const glm::vec3 from_target(std::sin(yaw) * std::cos(pitch), std::sin(pitch),
                                std::cos(yaw) * std::cos(pitch));
    return target + distance * from_target;
}

void OrbitCamera::orbit(const glm::vec2& pixels) {
    constexpr float RadiansPerPixel = 0.006f;
    yaw = std::remainder(yaw - RadiansPerPixel * pixels.x, 4.0f * QuarterTurn);
    pitch = std::clamp(pitch + RadiansPerPixel * pixels.y, -MaxPitch, MaxPitch);
}

void OrbitCamera::look(const glm::vec2& pixels) {
    const glm::vec3 before = eye();
    orbit(pixels);
    target += before - eye();
}

void OrbitCamera::fly(const glm::vec3& by) {
    const CameraFrame axes = frame(*this, {});
    target += by.x * glm::normalize(axes.right) + by.y * glm::vec3(0.0f, 1.0f, 0.0f) +
              by.z * axes.forward;
}

void OrbitCamera::pan(const glm::vec2& pixels, const PixelRectangle& viewport) {
    const CameraFrame axes = frame(*this, viewport);
    const float half_width = 0.5f * static_cast<float>(std::max(viewport.width, 1));
    const float half_height = 0.5f * static_cast<float>(std::max(viewport.height, 1));
    target += distance * (-pixels.x / half_width * axes.right + pixels.y / half_height * axes.up);
}

void OrbitCamera::zoom(float steps) {
    distance *= std::exp2(-0.2f * std::clamp(steps, -20.0f, 20.0f));
}

OrbitCamera orbit_camera(const relight::Camera& of_picture) {
    const relight::Camera camera = leveled(of_picture);
    const glm::vec3 from_target = camera.eye - camera.target;
    OrbitCamera result{.target = camera.target,
                       .distance = glm::length(from_target),
                       .fov_degrees = camera.fov_degrees};
    if (result.distance > 0.0f) {
        result.yaw = std::atan2(from_target.x, from_target.z);
        result.pitch =
            std::clamp(std::asin(std::clamp(from_target.y / result.distance, -1.0f, 1.0f)),
                       -MaxPitch, MaxPitch);
    }
    return result;
}

relight::Camera picture_camera(const OrbitCamera& camera) {
    return {.eye = camera.eye(), .target = camera.target, .fov_degrees = camera.fov_degrees};
}

std::string camera_options(const OrbitCamera& camera, const glm::dvec3& offset) {
    constexpr float Degrees = 90.0f / QuarterTurn;
    const glm::dvec3 target = glm::dvec3(camera.target) + offset;
    const int digits = offset == glm::dvec3(0.0) ? 5 : 11;
    return fmt::format("--camera {:.2f},{:.2f},{:.5g},{:.4g} --target {:.{}g},{:.{}g},{:.{}g}",
                       camera.yaw * Degrees, camera.pitch * Degrees, camera.distance,
                       camera.fov_degrees, target.x, digits, target.y, digits, target.z, digits);
}

CameraFrame frame(const OrbitCamera& camera, const PixelRectangle& viewport) {
    const glm::vec3 forward = glm::normalize(camera.target - camera.eye());
    const glm::vec3 right = glm::normalize(glm::cross(forward, glm::vec3(0.0f, 1.0f, 0.0f)));
    const float half_height = std::tan(0.5f * radians(camera.fov_degrees));
    return {.right = right * half_height * aspect(viewport),
            .up = glm::cross(right, forward) * half_height,
            .forward = forward};
}

glm::mat4 clip_from_world(const OrbitCamera& camera, const PixelRectangle& viewport, float reach) {
    // A hundredth of the way to the target: near enough to go inside, and fine in 24 bits of depth.
    const float near = 0.01f * camera.distance;
    const float far = camera.distance + 2.0f * reach;
    return glm::perspective(radians(camera.fov_degrees), aspect(viewport), near, far) *
           glm::lookAt(camera.eye(), camera.target, glm::vec3(0.0f, 1.0f, 0.0f));
}

std::array<glm::vec4, 4> picture_sides(const OrbitCamera& camera, const PixelRectangle& viewport) {
    const CameraFrame axes = frame(camera, viewport);
    const auto side = [&](const glm::vec3& axis) {
        const float reach = glm::length(axis);
        const glm::vec3 inwards = glm::normalize(axes.forward * reach - axis / reach);
        return glm::vec4(inwards, -glm::dot(inwards, camera.eye()));
    };
    return {side(axes.right), side(-axes.right), side(axes.up), side(-axes.up)};
}

Ray ray_through(const OrbitCamera& camera, const PixelRectangle& viewport, const glm::vec2& pixel) {
    const CameraFrame axes = frame(camera, viewport);
    const float across = 2.0f * (pixel.x - static_cast<float>(viewport.x)) /
                             static_cast<float>(std::max(viewport.width, 1)) -
                         1.0f;
    const float upwards = 1.0f - 2.0f * (pixel.y - static_cast<float>(viewport.y)) /
                                     static_cast<float>(std::max(viewport.height, 1));
    return {.origin = camera.eye(),
            .direction = glm::normalize(axes.forward + across * axes.right + upwards * axes.up)};
}

} // namespace relumine::viewer
