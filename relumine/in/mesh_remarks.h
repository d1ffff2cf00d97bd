// What a user should know of a mesh's file before anything is made of it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mesh/load.h"
#include "relumine/in/mesh.h"

namespace relumine {

/// One clause each.
struct MeshRemarks {
    /// What the file does not say, and how it is taken.
    std::vector<std::string> notes = {};
    /// What of the file is left out or changed: TriangleMesh::warnings.
    std::vector<std::string> left_out = {};
    /// Files that it names and that are not there: TriangleMesh::missing.
    std::vector<std::string> missing = {};
    /// What looks wrong.
    std::vector<std::string> doubts = {};
};

/// Returns them for a mesh that load_mesh() read with these options.
///
/// Cost:    as mesh::find_winding().
[[nodiscard]] MeshRemarks remarks_on(const Mesh& mesh, const MeshOptions& options = {});

} // namespace relumine
