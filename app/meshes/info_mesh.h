// `relumine info MESH`: the mesh doctor.
#pragma once

#include <span>
#include <string>

#include "app/session.h"
#include "relumine/in/mesh.h"

namespace relumine::app {

struct MeshInfoOptions {
    std::string path;
    /// The .png to draw. Empty: none.
    std::string picture;
    /// open_choices() alone
    MeshOptions mesh = {};
};

/// Says the names of what glows, as --emission takes them: a line each.
void say_lamps(std::span<const std::string> names, const Session& session);

/// Says what a mesh is and what may be wrong with it; docs/meshes.md explains every line.
void describe_mesh(const MeshInfoOptions& options, const Session& session);

} // namespace relumine::app
