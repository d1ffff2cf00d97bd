// A scene file ready to be lit: shared by relight, edit and verify.
#pragma once

#include <string>

#include "app/command_line.h"
#include "prt/scene/scene_file.h"
#include "prt/visibility/ray_scene.h"
#include "relight/shadow_rays.h"

namespace relumine::app {

/// The SCENE argument and its options.
struct SceneOptions {
    std::string path = {};
    bool clusters_only = false;
    /// A mesh will do: lit without clusters
    bool mesh_too = false;
    /// Of all surfaces, in place of the precompute's; empty: those
    std::string albedo = {};
    /// Of all highlights, likewise
    std::string specular = {};

    void add_to(Command& command);
};

/// The scene with its ray accelerator. Not movable: the shadow rays point into it.
class LitScene {
public:
    explicit LitScene(const SceneOptions& options);
    LitScene(const LitScene&) = delete;
    LitScene& operator=(const LitScene&) = delete;

    [[nodiscard]] const prt::Scene& scene() const { return scene_; }
    /// False for a mesh: its transfer is empty.
    [[nodiscard]] bool has_clusters() const { return scene_.transfer.num_receivers() != 0; }
    [[nodiscard]] const prt::RayScene& rays() const { return rays_; }
    /// For the Relighter: tracing of sharp lights, unless --clusters-only.
    [[nodiscard]] relight::ShadowRays shadow_rays() const;

private:
    prt::Scene scene_;
    prt::RayScene rays_;
    bool clusters_only_;
};

} // namespace relumine::app
