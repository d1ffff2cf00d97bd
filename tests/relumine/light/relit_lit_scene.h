// The scene of the tests of relighting, as a LitScene.
#pragma once

#include <cmath>
#include <memory>
#include <span>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "relumine/light/lit_scene.h"
#include "tests/relight/relit_scene.h"

namespace relumine::scenes {

/// ||a - b|| / ||b||.
[[nodiscard]] inline double relative_difference(std::span<const glm::vec3> a,
                                                std::span<const glm::vec3> b) {
    double difference = 0.0;
    double size = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const glm::dvec3 d = glm::dvec3(a[i]) - glm::dvec3(b[i]);
        difference += glm::dot(d, d);
        size += glm::dot(glm::dvec3(b[i]), glm::dvec3(b[i]));
    }
    return size == 0.0 ? std::sqrt(difference) : std::sqrt(difference / size);
}

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
