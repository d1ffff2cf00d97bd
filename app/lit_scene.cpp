#include "app/lit_scene.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "app/session.h"
#include "mesh/load.h"
#include "prt/receivers/receivers.h"

namespace relumine::app {

void SceneOptions::add_to(Command& command) {
    command
        .add_option("SCENE", path,
                    mesh_too ? "scene file from `relumine precompute`; with --lights a mesh, too"
                             : "scene file from `relumine precompute`")
        .file()
        .required();
    command.add_flag("--clusters-only", clusters_only,
                     "light the sun through its cluster too, without shadow rays of its own");
    command.add_option("--surface-albedo", albedo,
                       "scenes with materials: albedo of all surfaces in place of the "
                       "precompute's, a number or R,G,B");
    command.add_option(
        "--surface-specular", specular,
        "scenes with highlights: their F0 (Ks) in place of the precompute's, a number or R,G,B");
}

namespace {

prt::Scene load(const SceneOptions& options) {
    if (!options.mesh_too || !mesh::has_mesh_extension(options.path))
        return prt::load_scene(options.path);
    if (options.clusters_only)
        throw std::runtime_error(fmt::format(
            "{}: expected a scene file with --clusters-only, got a mesh", options.path));
    prt::Scene scene;
    scene.mesh = mesh::load(options.path);
    scene.receivers = prt::vertex_receivers(scene.mesh);
    scene.settings.bias = prt::automatic_bias(scene.mesh);
    return scene;
}

/// Colours are no part of the transfer: they may change.
void recolour(prt::Scene& scene, const SceneOptions& options) {
    if (options.albedo.empty() && options.specular.empty())
        return;
    if (scene.receivers.surfaces.empty())
        throw std::runtime_error(
            fmt::format("{}: expected a scene with materials for --surface-albedo and "
                        "--surface-specular, got one without",
                        options.path));
    for (prt::Surface& surface : scene.receivers.surfaces) {
        if (!options.albedo.empty())
            surface.albedo = parse_color("--surface-albedo", options.albedo);
        if (!options.specular.empty())
            surface.specular = parse_color("--surface-specular", options.specular);
    }
    prt::set_surfaces(scene.transfer, scene.receivers);
}

} // namespace

LitScene::LitScene(const SceneOptions& options)
    : scene_(load(options)), rays_(scene_.mesh), clusters_only_(options.clusters_only) {
    recolour(scene_, options);
}

relight::ShadowRays LitScene::shadow_rays() const {
    if (clusters_only_)
        return {};
    const prt::SceneSettings& settings = scene_.settings;
    const float tolerance =
        settings.epsilon
            ? *settings.epsilon * std::sqrt(static_cast<float>(scene_.transfer.num_receivers()))
            : settings.tolerance;
    return {.blockers = &rays_,
            .positions = scene_.receivers.positions,
            .bias = settings.bias,
            .tolerance = tolerance};
}

} // namespace relumine::app
