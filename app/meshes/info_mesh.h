// `relumine info MESH`: the mesh doctor.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "app/session.h"
#include "relumine/in/mesh_files.h"

namespace relumine::app {

struct MeshInfoOptions {
    std::string path;
    /// The .png to draw. Empty: none.
    std::string picture;
    std::optional<mesh::Pose> pose = {};
    std::optional<std::string> variant = {};
};

/// Says the names of what glows, as --emission takes them: a line each.
void say_lamps(std::span<const std::string> names, const Session& session);

/// Says what a mesh is and what may be wrong with it; docs/meshes.md explains every line.
void describe_mesh(const MeshInfoOptions& options, const Session& session);

} // namespace relumine::app
