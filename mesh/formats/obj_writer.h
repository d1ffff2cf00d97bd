// Writes Wavefront OBJ and MTL as text.
#pragma once

#include <string>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Returns the OBJ file of a mesh: coordinates that read back to the same bits, normals, uvs,
/// colours after the positions, groups, and materials of a library of that name.
[[nodiscard]] std::string obj(const TriangleMesh& mesh, const std::string& library);

/// Returns the library of the mesh's materials: their numbers, without images.
[[nodiscard]] std::string mtl(const TriangleMesh& mesh);

} // namespace relumine::mesh
