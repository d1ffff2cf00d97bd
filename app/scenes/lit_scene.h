// What is lit: a scene file, or a mesh with the scene that it gets by itself.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "app/command_line/command_line.h"
#include "app/session.h"
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
    /// What a mesh leaves open: open_choices() alone
    MeshOptions mesh = {};
    /// Lights a mesh without a precompute, and so without an environment.
    bool lights_alone = false;
    /// Looks at a mesh before its precompute, where there is one. Empty: nobody does.
    std::function<void(const Mesh&)> before = {};
    /// Colours of all surfaces, in place of those of the precompute
    SurfaceColors colors = {};

    void add_to(Command& command);
    /// Throws UsageError for an environment in place of the scene. lit_scene() does so, too.
    void check() const;
    /// SCENE is a mesh that is precomputed first, which says what its file leaves out.
    [[nodiscard]] bool is_first_picture() const;
};

/// The scene ready to be lit; of a scene file that processes share (Session::team), this one's
/// part. A mesh is precomputed first, as first_scene() does it.
///
/// Throws:  std::runtime_error for a file that cannot be read or has no use for the options;
///          UsageError for their wrong text; as first_scene().
[[nodiscard]] LitScene lit_scene(const SceneOptions& options, Session& session);

} // namespace relumine::app
