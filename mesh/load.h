// Mesh files in: OBJ, PLY, OFF, STL.
#pragma once

#include <filesystem>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

enum class NormalSource {
    File,   ///< the file's normals where it has them for every vertex, smooth ones otherwise
    Smooth, ///< always recomputed from the faces
};

/// Reads a mesh. The format is told by the extension (.obj .ply .off .stl, any case). Vertices keep the file's count
/// and order (STL, which has no vertices, is welded exactly); polygons are triangulated, concave ones included.
/// Throws std::runtime_error "path: expected X, got Y" when the file cannot be read, has no face, an index out of range,
/// a position that is not finite, or declares more than it can hold.
[[nodiscard]] TriangleMesh load(const std::filesystem::path& path, NormalSource normals = NormalSource::File);

} // namespace relumine::mesh
