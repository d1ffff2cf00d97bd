// The materials of a mesh as a table.
#pragma once

#include <string>
#include <vector>

#include "relumine/in/mesh_files.h"

namespace relumine::app {

/// Returns a line of headings and one for each material; columns that no material needs are left
/// out. Empty without materials.
[[nodiscard]] std::vector<std::string> material_table(const mesh::TriangleMesh& mesh);

} // namespace relumine::app
