// A scene file ready to be lit: shared by relight, edit and verify.
#pragma once

#include <string>

#include "app/command_line/command_line.h"
#include "relumine/lit_scene.h"
#include "relumine/shared_light.h"

namespace relumine::app {

/// The SCENE argument and its options.
struct SceneOptions {
    std::string path = {};
    bool clusters_only = false;
    /// The argument may also be a mesh, which is lit without clusters.
    bool mesh_too = false;
    /// Albedo of all surfaces. Empty: the albedo of the precompute.
    std::string albedo = {};
    /// F0 (Ks) of all highlights. Empty: the values of the precompute.
    std::string specular = {};

    void add_to(Command& command);
};

/// The scene, or the mesh, ready to be lit. Throws std::runtime_error for a file that cannot be
/// read or has no use for the options, UsageError for their wrong text.
[[nodiscard]] LitScene lit_scene(const SceneOptions& options);

/// The same for the processes of a team, each with its part of a scene file.
[[nodiscard]] SharedLight shared_light(const SceneOptions& options, prt::Team& team);

} // namespace relumine::app
