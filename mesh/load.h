// Reads mesh files: OBJ with MTL, glTF, PLY, OFF, STL.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/camera.h"
#include "mesh/normals.h"
#include "mesh/pose.h"
#include "mesh/triangle_mesh.h"
#include "mesh/vertex_colors.h"

namespace relumine::mesh {

struct LoadOptions {
    NormalSource normals = NormalSource::File;
    /// A moment of an animation, in place of the pose that the nodes of a glTF file say
    std::optional<Pose> pose = {};
    /// The name of a look that a glTF file offers (KHR_materials_variants)
    std::optional<std::string> variant = {};
    /// What colours of vertices and faces mean. Empty: sRGB for bytes and for text, linear for
    /// floats of PLY and for glTF
    std::optional<ColorCurve> colors = {};
    /// glTF: the set of uvs, TEXCOORD_n, that becomes second_uvs where no texture uses another one
    std::optional<std::uint32_t> lightmap_uvs = {};
};

/// A mesh, with what else its file says.
struct LoadedMesh : TriangleMesh {
    /// xxHash64 of the file's bytes
    std::uint64_t hash = 0;
    /// Some normals are the file's
    bool has_normals = false;
    /// The first perspective camera of a glTF scene, or its first orthographic one, from afar
    std::optional<Camera> camera = {};
    /// Names of the looks that a glTF file offers
    std::vector<std::string> variants = {};
};

/// Reads a mesh. The extension tells the format (mesh_extensions(), any case).
///
/// The file's vertices come first, in its order. STL has no shared vertices, so equal points are
/// welded exactly. Polygons are triangulated, also concave and degenerate ones: n corners give n -
/// 2 triangles. Faces of one or two corners are skipped, with a warning.
///
/// A mesh of coordinates below 2^-40 is enlarged by a power of two, with a warning.
///
/// Vertices whose corners have several normals, or faces of several colours, are repeated behind
/// all others (TriangleMesh). Faces of glTF without normals are flat, and those of OBJ where `s
/// off` says so. Other faces without normals are smooth.
///
/// Colours become linear, without alpha. Numbers of 0 to 255 are recognised. A vertex without a
/// colour is white where others have one. Uvs are left out if some are not finite. An OBJ whose
/// vertices have several uvs, or none, and a PLY with uvs of wedges have corner_uvs instead.
///
/// Materials, groups and textures come with OBJ and glTF (docs/materials.md). A missing material
/// library or image does not stop the load; TriangleMesh::missing has its name. A broken one
/// does not stop it either, nor a material that cannot be read: TriangleMesh::warnings says so, and
/// the surface is grey or without its texture.
///
/// The skins and morph targets of a glTF file are as its nodes say, or as the pose does. Nodes that
/// the file hides are not there.
///
/// Throws:  std::runtime_error "path: expected X, got Y" if the file cannot be read, has no face of
///          three corners, has an index out of range or a position that is not finite, or declares
///          more or less than it holds; for a pose or a variant of a file that is no glTF, or
///          does not have it.
[[nodiscard]] LoadedMesh load(const std::filesystem::path& path, const LoadOptions& options = {});

/// Reads the vertices of a .ply file, which need not have faces or be finite. `offset` is taken off
/// them: that of a mesh among whose coordinates they are.
///
/// Throws:  std::runtime_error "path: expected X, got Y".
[[nodiscard]] std::vector<glm::vec3> load_points(const std::filesystem::path& path,
                                                 const glm::dvec3& offset = glm::dvec3(0.0));

/// Returns ".glb, .gltf, .obj, .off, .ply or .stl".
[[nodiscard]] std::string mesh_extensions();

/// Returns true if load() knows the path's extension, in capitals or not.
[[nodiscard]] bool has_mesh_extension(const std::filesystem::path& path);

} // namespace relumine::mesh
