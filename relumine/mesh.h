// Meshes, as load_mesh() reads them and precompute() takes them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "mesh/load.h"
#include "mesh/triangle_mesh.h"
#include "mesh/up_axis.h"

namespace relumine {

/// A triangle mesh and its origin. A TriangleMesh made in code converts to it.
struct Mesh {
    mesh::TriangleMesh geometry;
    /// The path as it was given, or empty. Messages name the path. A scene file keeps its last
    /// part.
    std::string source;
    /// xxHash64 of the file's bytes, 0 without a file
    std::uint64_t source_hash = 0;
    /// n: the last n x n vertices are a floor under the mesh. 0: there is no floor.
    std::uint32_t floor_vertices = 0;

    Mesh() = default;
    // NOLINTNEXTLINE(google-explicit-constructor): a mesh made in code is a mesh
    Mesh(mesh::TriangleMesh triangles) : geometry(std::move(triangles)) {}
};

struct MeshOptions {
    /// The file's axis that points up. Empty: Z for .stl, Y for all others.
    std::optional<mesh::UpAxis> up = {};
    /// Where normals come from: the file if it has them, or always the faces.
    mesh::NormalSource normals = mesh::NormalSource::File;
    /// n: adds a floor of n x n vertices under the mesh; 193 gives the scenes of [JN]
    std::optional<std::uint32_t> floor_vertices = {};
    /// Side of the floor, in widths of the mesh.
    float floor_scale = 4.0f;
};

/// Reads an .obj, .gltf, .glb, .ply, .off or .stl file, turns it upright and adds the floor.
///
/// Throws:  std::runtime_error "path: expected X, got Y" for a file that cannot be read;
///          std::invalid_argument for a floor that does not fit (mesh::append_floor()).
/// Cost:    reads the file twice, once for its hash.
[[nodiscard]] Mesh load_mesh(const std::filesystem::path& path, const MeshOptions& options = {});

} // namespace relumine
