// The scene of the tests of relighting, as a LitScene.
#pragma once

#include <memory>

#include "relumine/lit_scene.h"
#include "tests/relight/relit_scene.h"

namespace relumine::scenes {

/// One for all tests.
[[nodiscard]] inline const std::shared_ptr<const Scene>& whole_relit_scene() {
    static const auto scene = std::make_shared<const Scene>(
        Scene{.mesh = relit_scene().mesh,
              .transfer = relit_scene().transfer,
              .settings = {.tolerance = relit_scene().options.tolerance,
                           .bias = relit_scene().options.bias},
              .receivers = relit_scene().receivers});
    return scene;
}

/// Without shadow rays.
[[nodiscard]] inline LitScene relit_clusters() {
    return LitScene(whole_relit_scene(), {.clusters_only = true});
}

} // namespace relumine::scenes
