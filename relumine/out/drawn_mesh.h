// The mesh of a scene for programs that draw it by themselves.
#pragma once

#include "mesh/triangle_mesh.h"
#include "relumine/in/scene.h"

namespace relumine {

/// Returns the scene's mesh, whose vertices are its receivers where these are vertices. A sheet
/// whose front and back are lit by themselves has both as triangles at one place: these get
/// materials of which only the front is drawn. Of two that show both sides, viewers draw now one
/// and now the other.
///
/// Cost:    O(triangles log triangles).
[[nodiscard]] mesh::TriangleMesh drawn_mesh(const Scene& scene);

} // namespace relumine
