// The camera of the scene's view: turns about a point. Without a window.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "relight/pictures/picture.h"
#include "viewer/panel_layout.h"

namespace relumine::viewer {

/// Angles in radians; yaw 0 looks along -Z from +Z, a quarter turn looks from +X.
struct OrbitCamera {
    glm::vec3 target{0.0f};
    float distance = 1.0f;
    float yaw = 0.0f;
    /// Above the horizon, within a quarter turn
    float pitch = 0.0f;
    float fov_degrees = 35.0f;

    /// Drags by pixels: to the right turns the scene to the right, down shows more of its top.
    void orbit(const glm::vec2& pixels);
    /// Drags by pixels: the target's plane follows the pointer.
    void pan(const glm::vec2& pixels, const PixelRectangle& viewport);
    /// Wheel steps: towards the target for positive ones.
    void zoom(float steps);

    [[nodiscard]] glm::vec3 eye() const;
};

struct Ray {
    glm::vec3 origin{0.0f};
    /// unit
    glm::vec3 direction{0.0f, 0.0f, -1.0f};
};

/// Axes of the picture: right and up reach its edges at distance 1 along `forward`.
struct CameraFrame {
    glm::vec3 right{1.0f, 0.0f, 0.0f};
    glm::vec3 up{0.0f, 1.0f, 0.0f};
    glm::vec3 forward{0.0f, 0.0f, -1.0f};
};

/// The camera that sees the same as another: right way up, target at the same place.
[[nodiscard]] OrbitCamera orbit_camera(const relight::Camera& camera);
[[nodiscard]] CameraFrame frame(const OrbitCamera& camera, const PixelRectangle& viewport);
/// World to OpenGL's clip space; `reach` is how far from the target the scene goes.
[[nodiscard]] glm::mat4 clip_from_world(const OrbitCamera& camera, const PixelRectangle& viewport,
                                        float reach);
/// Through a pixel's position, in the window's coordinates.
[[nodiscard]] Ray ray_through(const OrbitCamera& camera, const PixelRectangle& viewport,
                              const glm::vec2& pixel);

} // namespace relumine::viewer
