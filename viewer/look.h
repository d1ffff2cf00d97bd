// How the two pictures of the window look.
#pragma once

#include "relumine/out/output_options.h"
#include "relumine/out/pictures.h"

namespace relumine::viewer {

/// How the floor is drawn while something moves.
struct FloorScene {
    FloorLook look = FloorLook::Grey;
    relight::Ground ground = {};
    /// The radiance of a floor that nothing shades.
    glm::vec3 open{1.0f};
    /// The radiance of a studio's floor.
    glm::vec3 color{0.0f};
};

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
