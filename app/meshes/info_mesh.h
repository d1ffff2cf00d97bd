// `relumine info MESH`: the mesh doctor.
#pragma once

#include <string>

#include "app/session.h"

namespace relumine::app {

struct MeshInfoOptions {
    std::string path;
    /// The .png to draw. Empty: none.
    std::string picture;
};

/// Says what a mesh is and what may be wrong with it; docs/meshes.md explains every line.
void describe_mesh(const MeshInfoOptions& options, const Session& session);

} // namespace relumine::app
