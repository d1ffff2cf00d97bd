// How the two pictures of the window look.
#pragma once

#include <span>

#include <glm/vec3.hpp>

namespace relumine::viewer {

struct SceneLook {
    float exposure_ev = 0.0f;
    bool wireframe = false;
    bool background = true; ///< the environment behind the mesh
};

struct EnvironmentLook {
    float exposure_ev = 0.0f;
    bool quadtree = false; ///< the clusters' borders
    bool heat = false;     ///< what lights the chosen receiver
};

/// An exposure that shows radiances well: 0, as `relumine relight` has it, where that leaves the brightest fiftieth neither dark nor far
/// beyond white; else what makes it white, in half stops.
[[nodiscard]] float sane_exposure_ev(std::span<const glm::vec3> radiance);

} // namespace relumine::viewer
