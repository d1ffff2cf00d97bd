// Mesh files out: PLY and binary glTF with float vertex colours.
#pragma once

#include <filesystem>
#include <span>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Writes the mesh with one linear RGB colour per vertex as .ply (binary little-endian, float
/// red/green/blue) or .glb (COLOR_0 as float RGB on an unlit material), told by the extension.
/// `colors`: [num_vertices]. The file appears whole or not at all (temporary name beside the
/// target, fsync, rename). Throws std::runtime_error naming the path.
void save(const std::filesystem::path& path, const TriangleMesh& mesh,
          std::span<const glm::vec3> colors);

} // namespace relumine::mesh
