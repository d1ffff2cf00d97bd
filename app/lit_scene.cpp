#include "app/lit_scene.h"

#include <cmath>

namespace relumine::app {

void SceneOptions::add_to(CLI::App& command) {
    command.add_option("SCENE", path, "scene file from `relumine precompute`")->required();
    command.add_flag("--clusters-only", clusters_only,
                     "light the sun through its cluster too, without shadow rays of its own");
}

LitScene::LitScene(const SceneOptions& options)
    : scene_(prt::load_scene(options.path)), rays_(scene_.mesh), clusters_only_(options.clusters_only) {}

relight::ShadowRays LitScene::shadow_rays() const {
    if (clusters_only_)
        return {};
    const prt::SceneSettings& settings = scene_.settings;
    const float tolerance =
        settings.epsilon ? *settings.epsilon * std::sqrt(static_cast<float>(scene_.transfer.num_receivers()))
                         : settings.tolerance;
    return {.blockers = &rays_,
            .positions = scene_.mesh.positions,
            .bias = settings.bias,
            .tolerance = tolerance};
}

} // namespace relumine::app
