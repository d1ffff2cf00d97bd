// Writes mesh files: PLY and binary glTF with float vertex colours.
#pragma once

#include <filesystem>
#include <span>

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

} // namespace relumine::mesh
