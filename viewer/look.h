// How the two pictures of the window look.
#pragma once

namespace relumine::viewer {

struct SceneLook {
    float exposure_ev = 0.0f;
    bool wireframe = false;
    /// Shows the environment behind the mesh.
    bool background = true;
};

struct EnvironmentLook {
    float exposure_ev = 0.0f;
    /// Shows the clusters' borders.
    bool quadtree = false;
    /// Shows the light that reaches the chosen receiver.
    bool heat = false;
};

} // namespace relumine::viewer
