// How the two pictures of the window look.
#pragma once

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

} // namespace relumine::viewer
