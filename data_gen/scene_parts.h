// Functions that the scenes share. Not for other files.
#pragma once

#include <cstddef>
#include <numbers>

#include "mesh/triangle_mesh.h"

namespace relumine::data_gen {

inline constexpr double FullTurn = 2.0 * std::numbers::pi;

/// Throws:  std::invalid_argument outside [MinSceneVertices, MaxSceneVertices].
void check_num_vertices(std::size_t num_vertices);

/// Adds normals and a floor to the objects. The floor gets the remaining vertices.
[[nodiscard]] mesh::TriangleMesh on_ground(mesh::TriangleMesh objects, double floor_side,
                                           std::size_t num_vertices);

} // namespace relumine::data_gen
