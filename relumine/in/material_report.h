// Materials of a mesh as `info --json` and Python tell them.
#pragma once

#include "files/json.h"
#include "mesh/triangle_mesh.h"

namespace relumine {

/// Returns the numbers of a material and the names of its textures. What changes nothing is left
/// out.
[[nodiscard]] files::Json report_of(const mesh::TriangleMesh& mesh, const mesh::Material& material);

} // namespace relumine
