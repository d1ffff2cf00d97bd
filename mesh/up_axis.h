// Meshes of programs with another axis up.
#pragma once

#include <cstdint>
#include <filesystem>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// The axis of a file that points up.
enum class UpAxis : std::uint8_t { X, Y, Z };

/// Returns the axis that files of this extension have up by custom: Z for .stl, which comes from
/// CAD and printing, Y for all others.
[[nodiscard]] UpAxis customary_up(const std::filesystem::path& path);

/// Turns a mesh so that the axis becomes +Y: Z up turns about X, and what was -Y faces +Z then; X
/// up turns about Z. Y changes nothing.
void turn_up(TriangleMesh& mesh, UpAxis axis);

} // namespace relumine::mesh
