// What files of a format are by custom, where they do not say it, and what their shape suggests.
#pragma once

#include <filesystem>
#include <optional>

#include "mesh/triangle_mesh.h"
#include "mesh/up_axis.h"

namespace relumine::mesh {

/// Returns the axis that files of this extension have up by custom: Z for .stl, which comes from
/// CAD and printing, Y for all others.
[[nodiscard]] UpAxis customary_up(const std::filesystem::path& path);

/// Returns the angle in degrees beyond which edges are sharp: 40 for .stl, which has no normals of
/// vertices and comes from CAD, none for others.
[[nodiscard]] std::optional<float> customary_crease(const std::filesystem::path& path);

/// Returns true if the mesh of the first `num_vertices` vertices stands on a flat side towards -Z,
/// and has none towards -Y: +Z is likely up. Always false for flat meshes.
[[nodiscard]] bool stands_on_z(const TriangleMesh& mesh, std::size_t num_vertices);

} // namespace relumine::mesh
