// Writes mesh files: PLY, binary glTF and OBJ.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Writes the mesh with the light of its vertices: the colours in which viewers show it, radiance
/// above 1 as 1, and beside them the linear radiance itself. The extension tells the format: .ply
/// (binary little-endian; red, green and blue are bytes of sRGB; floats radiance_red, _green and
/// _blue) or .glb (an unlit material, COLOR_0 and _RADIANCE are linear floats). Vertices are at
/// their place in the file that was read: .ply has doubles for a mesh with an offset, .glb a node
/// that moves it. The file appears whole or not at all.
///
/// Shape:   `radiance` is [num_vertices].
/// Throws:  std::runtime_error naming the path.
void save_lit(const std::filesystem::path& path, const TriangleMesh& mesh,
              std::span<const glm::vec3> radiance);

/// Writes the mesh as it is, for other programs and for load(): .ply (binary little-endian:
/// normals, float colours, uvs of vertices), .glb (all of it: uvs, groups as nodes, materials with
/// the images of their textures) or .obj (uvs, groups, and the names and numbers of materials in a
/// .mtl file beside it). Each file appears whole or not at all.
///
/// Returns what is left out, a line each: textures but for .glb; for .ply groups, uvs of corners
/// and materials.
/// Throws:  std::runtime_error naming the path.
std::vector<std::string> save(const std::filesystem::path& path, const TriangleMesh& mesh);

} // namespace relumine::mesh
