// The camera of the scene's view, which turns about a point. Works without a window.
#pragma once

#include <array>
#include <string>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "relumine/out/pictures.h"
#include "viewer/panel_layout.h"

namespace relumine::viewer {

/// A camera by angles in radians. Yaw 0 looks along -Z from +Z; a quarter turn looks from +X.
struct OrbitCamera {
    glm::vec3 target{0.0f};
    float distance = 1.0f;
    float yaw = 0.0f;
    /// Above the horizon, within a quarter turn.
    float pitch = 0.0f;
    float fov_degrees = 35.0f;

    /// Turns by a drag in pixels: to the right turns the scene to the right, down shows more of its
    /// top.
    void orbit(const glm::vec2& pixels);
    /// Looks around by a drag in pixels: the eye stays.
    void look(const glm::vec2& pixels);
    /// Moves the eye to the right, upwards and forwards, in the mesh's unit.
    void fly(const glm::vec3& by);
    /// Shifts by a drag in pixels: the target's plane follows the pointer.
    void pan(const glm::vec2& pixels, const PixelRectangle& viewport);
    /// Zooms by wheel steps; positive ones go towards the target.
    void zoom(float steps);

    [[nodiscard]] glm::vec3 eye() const;
    bool operator==(const OrbitCamera&) const = default;
};

struct Ray {
    glm::vec3 origin{0.0f};
    /// Unit length.
    glm::vec3 direction{0.0f, 0.0f, -1.0f};
};

/// Axes of the picture: right and up reach its edges at distance 1 along `forward`.
struct CameraFrame {
    glm::vec3 right{1.0f, 0.0f, 0.0f};
    glm::vec3 up{0.0f, 1.0f, 0.0f};
    glm::vec3 forward{0.0f, 0.0f, -1.0f};
};

/// Returns the camera with the same view as another: right way up, target at the same place. What
/// leveled() leaves out of its roll is left out.
[[nodiscard]] OrbitCamera orbit_camera(const relight::Camera& of_picture);
[[nodiscard]] relight::Camera picture_camera(const OrbitCamera& camera);
/// Returns the options of `relumine relight` for this view: "--camera 24,20,3,35 --target 0,1,0".
/// `offset` is that of the mesh: options count as its file does.
[[nodiscard]] std::string camera_options(const OrbitCamera& camera, const glm::dvec3& offset);
[[nodiscard]] CameraFrame frame(const OrbitCamera& camera, const PixelRectangle& viewport);
/// Returns the matrix from world to OpenGL's clip space. `reach` is how far the scene extends from
/// the target.
[[nodiscard]] glm::mat4 clip_from_world(const OrbitCamera& camera, const PixelRectangle& viewport,
                                        float reach);
/// Returns the planes through the eye and the sides of the picture: a point p is in the picture
/// where dot(xyz, p) + w >= 0 for each.
[[nodiscard]] std::array<glm::vec4, 4> picture_sides(const OrbitCamera& camera,
                                                     const PixelRectangle& viewport);
/// Returns the ray through a pixel's position, in the window's coordinates.
[[nodiscard]] Ray ray_through(const OrbitCamera& camera, const PixelRectangle& viewport,
                              const glm::vec2& pixel);

} // namespace relumine::viewer
