// Functions that the scenes share. Not for other files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>

#include "mesh/triangle_mesh.h"

namespace relumine::data_gen {

inline constexpr double FullTurn = 2.0 * std::numbers::pi;

/// Throws:  std::invalid_argument outside [MinSceneVertices, MaxSceneVertices].
void check_num_vertices(std::size_t num_vertices);

/// Returns the knot's surface about the origin, its vertices about `spacing` apart, without
/// normals.
[[nodiscard]] mesh::TriangleMesh knot_surface(double spacing);

/// Returns the boulder's surface, made of icosphere(frequency), without normals.
[[nodiscard]] mesh::TriangleMesh boulder_surface(std::uint32_t frequency);

/// Returns the frequency of an icosphere() whose vertices lie about `spacing` apart at this radius.
[[nodiscard]] std::uint32_t ball_frequency(double radius, double spacing,
                                           std::uint32_t minimum = 1);

/// Adds normals and a floor to the objects. The floor gets the remaining vertices.
[[nodiscard]] mesh::TriangleMesh on_ground(mesh::TriangleMesh objects, double floor_side,
                                           std::size_t num_vertices);

} // namespace relumine::data_gen
