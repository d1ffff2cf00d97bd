// A mesh that is lit without a precompute of its own.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "app/session.h"
#include "relumine/in/mesh.h"
#include "relumine/in/scene.h"

namespace relumine::app {

/// Precomputes a mesh on a floor, with the options that `relumine precompute` has by itself, or
/// takes the scene from the user's cache. Says what took long. `read`: how the mesh is read,
/// without a floor. `before`: looks at the mesh before it is precomputed, if it is; may be empty.
///
/// Throws:  as load_mesh() and precompute().
[[nodiscard]] Scene first_scene(const std::string& path, const MeshOptions& read,
                                const std::function<void(const Mesh&)>& before, Session& session);

/// Precomputes a mesh as `relumine precompute` does by itself, without a floor, and keeps its
/// groups. Says what was done.
///
/// Throws:  as load_mesh() and precompute().
[[nodiscard]] Scene precomputed_scene(const std::string& path, Session& session);

} // namespace relumine::app
