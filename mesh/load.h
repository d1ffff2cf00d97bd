// Mesh files in: OBJ with MTL, glTF, PLY, OFF, STL.
#pragma once

#include <filesystem>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

enum class NormalSource {
    /// The file's normals where it has them for every vertex, smooth ones otherwise
    File,
    /// Always recomputed from the faces
    Smooth,
};

/// Reads a mesh. The format is told by the extension (.obj .gltf .glb .ply .off .stl, any case).
/// Vertices keep the file's count and order (STL, which has no vertices, is welded exactly);
/// polygons are triangulated, concave ones included, n corners into n - 2 triangles, degenerate
/// ones as well. Faces of one or two corners are skipped. Colours come as the file has them, bytes
/// divided by 255, without alpha; those of faces are skipped. Colours and uvs are left out where
/// some are not finite. OBJ whose vertices have several uvs, or none, has corner_uvs instead.
/// Materials, groups and textures come with OBJ and glTF (docs/materials.md). Material libraries
/// and images that are not there do not stop the load: TriangleMesh::missing has their names. Those
/// that are there and broken do. Throws std::runtime_error "path: expected X, got Y" when the file
/// cannot be read, has no face of three corners, an index out of range, a position that is not
/// finite, or declares more or less than it holds.
[[nodiscard]] TriangleMesh load(const std::filesystem::path& path,
                                NormalSource normals = NormalSource::File);

/// Whether load() knows the path's extension, in capitals or not.
[[nodiscard]] bool has_mesh_extension(const std::filesystem::path& path);

} // namespace relumine::mesh
