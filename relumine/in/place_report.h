// Places on a mesh, as reports and files name them: among the coordinates of the mesh's file.
#pragma once

#include <string>

#include <glm/vec3.hpp>

#include "files/json.h"
#include "mesh/triangle_mesh.h"

namespace relumine {

/// Returns "x, y, z" of a position of the mesh.
[[nodiscard]] std::string place_text(const mesh::TriangleMesh& mesh, const glm::vec3& position);

/// Returns [x, y, z] of a position of the mesh.
[[nodiscard]] files::Json place_json(const mesh::TriangleMesh& mesh, const glm::vec3& position);

} // namespace relumine
