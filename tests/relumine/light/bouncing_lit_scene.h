// A scene whose light bounces, as a LitScene's.
#pragma once

#include <memory>

#include "relumine/in/scene.h"
#include "tests/relight/bounces/bouncing_scene.h"

namespace relumine::scenes {

[[nodiscard]] inline std::shared_ptr<const Scene>
whole_bouncing_scene(const relight::BouncingScene& parts) {
    return std::make_shared<const Scene>(Scene{.mesh = parts.mesh,
                                               .transfer = parts.transfer,
                                               .settings = {.tolerance = 0.05f, .bias = parts.bias},
                                               .receivers = parts.receivers,
                                               .bounces = parts.matrix});
}

} // namespace relumine::scenes
