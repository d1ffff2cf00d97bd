// Parts of scenes that are regular grids. All functions append to a mesh; the caller sets the
// normals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::data_gen {

/// Returns the number of intervals of about `spacing` that a length is cut into, at least
/// `minimum`.
[[nodiscard]] std::uint32_t num_intervals(double length, double spacing, std::uint32_t minimum = 1);

/// Appends a closed box with faces of about evenly spaced vertices. Each face has its own vertices,
/// so edges are sharp.
void append_box(mesh::TriangleMesh& mesh, const glm::dvec3& min, const glm::dvec3& max,
                double spacing);

/// A rectangle on an axis-aligned plane. Its coordinates are those of the axes after the plane's: y
/// and z on a plane of constant x, z and x for y, x and y for z.
struct PlaneRectangle {
    glm::dvec2 min{0.0};
    glm::dvec2 max{0.0};
};

/// A rectangular wall without thickness.
struct Wall {
    /// The axis that the wall is perpendicular to: 0, 1 or 2.
    int axis = 1;
    /// The wall's coordinate on this axis.
    double at = 0.0;
    /// The wall faces the axis' larger coordinates, otherwise the smaller ones.
    bool faces_up = true;
    PlaneRectangle outline;
};

/// Appends a wall of about evenly spaced vertices. Rectangles are left out of it; vertices lie
/// along their edges.
void append_wall(mesh::TriangleMesh& mesh, const Wall& wall, double spacing,
                 std::span<const PlaneRectangle> holes = {});

/// Appends a square floor at y = 0 about the origin. It faces +Y and has close to `num_vertices`
/// vertices (at least 4).
void append_ground(mesh::TriangleMesh& mesh, double side, std::size_t num_vertices);

/// Appends a closed torus-like grid of num_u x num_v vertices. `position(i, j)` runs once around in
/// each index, and (d/di x d/dj) points outside.
void append_wrapped_grid(mesh::TriangleMesh& mesh, std::uint32_t num_u, std::uint32_t num_v,
                         const std::function<glm::dvec3(std::uint32_t, std::uint32_t)>& position);

/// Appends a copy of `part`'s positions and triangles, turned about +Y (from +Z towards +X) and
/// then moved.
void append_copy(mesh::TriangleMesh& mesh, const mesh::TriangleMesh& part, double azimuth_radians,
                 const glm::dvec3& offset);

} // namespace relumine::data_gen
