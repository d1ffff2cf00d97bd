// Writes mesh files: PLY and binary glTF with float vertex colours.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Writes the mesh with one linear RGB colour per vertex. The extension tells the format: .ply
/// (binary little-endian, float red/green/blue) or .glb (COLOR_0 as float RGB on an unlit
/// material). The file appears whole or not at all.
///
/// Shape:   `colors` is [num_vertices].
/// Throws:  std::runtime_error naming the path.
void save(const std::filesystem::path& path, const TriangleMesh& mesh,
          std::span<const glm::vec3> colors);

/// Writes the mesh as it is, for other programs and for load(): .ply (binary little-endian:
/// normals, float colours, uvs of vertices), .glb (also materials) or .obj (also uvs of corners,
/// groups, and the names and numbers of materials in a .mtl file beside it). Each file appears
/// whole or not at all.
///
/// Returns what is left out, a line each: textures; for .ply and .glb groups and uvs of corners,
/// for .ply materials, for .glb uvs.
/// Throws:  std::runtime_error naming the path.
std::vector<std::string> save(const std::filesystem::path& path, const TriangleMesh& mesh);

} // namespace relumine::mesh
