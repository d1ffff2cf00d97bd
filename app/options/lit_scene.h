// A scene file ready to be lit: shared by relight, edit and verify.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/command_line/command_line.h"
#include "relumine/in/mesh.h"
#include "relumine/light/lit_scene.h"

namespace relumine::app {

/// The SCENE argument and its options.
struct SceneOptions {
    std::string path = {};
    bool clusters_only = false;
    /// Order of the spherical harmonics: 2 or 3; 0: none (LightOptions::harmonics)
    std::uint32_t harmonics = 0;
    /// Order of the spherical harmonics of receivers that are points in space; 0: `harmonics`
    std::uint32_t harmonics_of_points = 0;
    /// Rays that find a pixel's highlights; 0: none (LightOptions::highlight_rays)
    std::uint32_t highlight_rays = DefaultHighlightRays;
    /// The argument may also be a mesh, which is lit without clusters.
    bool mesh_too = false;
    /// The moment of a mesh's animation (MeshOptions::pose)
    std::optional<mesh::Pose> pose = {};
    /// Colours of all surfaces, in place of those of the precompute
    SurfaceColors colors = {};

    void add_to(Command& command);
};

/// The scene, or the mesh, ready to be lit; of a scene file that processes share, this one's part.
/// Throws std::runtime_error for a file that cannot be read or has no use for the options,
/// UsageError for their wrong text.
[[nodiscard]] LitScene lit_scene(const SceneOptions& options, prt::Team* team = nullptr);

/// A scene that is there, ready to be lit; its path is for messages.
[[nodiscard]] LitScene lit_scene(Scene scene, const SceneOptions& options);

} // namespace relumine::app
