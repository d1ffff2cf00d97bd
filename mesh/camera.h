// A camera, as files have it and pictures are seen from it.
#pragma once

#include <glm/vec3.hpp>

namespace relumine::mesh {

/// A pinhole camera, +Y up.
struct Camera {
    glm::vec3 eye{0.0f};
    glm::vec3 target{0.0f};
    /// Vertical field of view.
    float fov_degrees = 35.0f;
    bool operator==(const Camera&) const = default;
};

} // namespace relumine::mesh
