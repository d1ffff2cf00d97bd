// Building blocks of the scenes that are regular grids. All append to a mesh and leave its normals
// to the caller.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::data_gen {

/// Intervals to cut a length into so that they are about `spacing` long; at least `minimum`.
[[nodiscard]] std::uint32_t num_intervals(double length, double spacing, std::uint32_t minimum = 1);

/// A closed box with faces of about evenly spaced vertices; each face has its own, so that edges
/// are sharp.
void append_box(mesh::TriangleMesh& mesh, const glm::dvec3& min, const glm::dvec3& max,
                double spacing);

/// A square floor at y = 0 about the origin, facing +Y, with close to `num_vertices` (at least 4)
/// vertices.
void append_ground(mesh::TriangleMesh& mesh, double side, std::size_t num_vertices);

/// A closed torus-like grid of num_u x num_v vertices; `position(i, j)` runs once around in each
/// index, and (d/di x d/dj) points outside.
void append_wrapped_grid(mesh::TriangleMesh& mesh, std::uint32_t num_u, std::uint32_t num_v,
                         const std::function<glm::dvec3(std::uint32_t, std::uint32_t)>& position);

/// A copy of `part`'s positions and triangles, turned about +Y (from +Z towards +X) and then moved.
void append_copy(mesh::TriangleMesh& mesh, const mesh::TriangleMesh& part, double azimuth_radians,
                 const glm::dvec3& offset);

} // namespace relumine::data_gen
