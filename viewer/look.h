// How the two pictures of the window look.
#pragma once

#include "relight/pictures/tone_curve.h"

namespace relumine::viewer {

struct SceneLook {
    float exposure_ev = 0.0f;
    relight::ToneCurve tone = relight::ToneCurve::Neutral;
    bool wireframe = false;
    /// Shows the environment behind the mesh.
    bool background = true;
};

struct EnvironmentLook {
    float exposure_ev = 0.0f;
    relight::ToneCurve tone = relight::ToneCurve::Neutral;
    /// Shows the clusters' borders.
    bool quadtree = false;
    /// Shows the light that reaches the chosen receiver.
    bool heat = false;
};

} // namespace relumine::viewer
