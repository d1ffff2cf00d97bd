// The camera that a mesh file has.
#pragma once

#include <glm/vec3.hpp>

namespace relumine::mesh {

/// Where the camera of a file stands and looks, upright.
struct FileCamera {
    glm::vec3 eye{0.0f};
    /// A point ahead, about as far away as the middle of the mesh.
    glm::vec3 target{0.0f};
    /// Vertical
    float fov_degrees = 0.0f;
};

} // namespace relumine::mesh
