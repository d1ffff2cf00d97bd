// Receivers without a surface: points in space, which see the whole sphere.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/receivers/receiver_layout.h"
#include "prt/receivers/receivers.h"
#include "prt/visibility/ray_scene.h"
#include "prt/work.h"

namespace relumine::prt {

/// A limit on points, which bounds what is allocated.
inline constexpr std::size_t MaxPoints = std::size_t{1} << 24;

/// Points have no horizon, and the borders of shadows pass each of them elsewhere. So a tolerance
/// either splits nearly all cells or few, and it cannot tell which ones light comes from. Even,
/// small cells serve them better: cells of 1.4 degrees. Measured: docs/harmonics.md.
inline constexpr std::uint32_t MinLevelOfPoints = 6;

/// Returns the middles of the cells, [nx * ny * nz], x fastest.
[[nodiscard]] std::vector<glm::vec3> grid_points(const GridLayout& grid);

/// Returns receivers at points. A point is inside of an object where most of its rays meet the
/// backs of surfaces. It gets the position of the nearest point that is not inside, and so this
/// point's light: interpolation between points does not darken where objects begin. Where all
/// points are inside, all stay where they are.
///
/// Cost:    64 rays a point; parallel.
/// Throws:  std::invalid_argument for no points, more than MaxPoints, and coordinates that are not
///          finite; Cancelled.
[[nodiscard]] Receivers point_receivers(std::span<const glm::vec3> points,
                                        const mesh::TriangleMesh& mesh, const RayScene& rays,
                                        const Work& work = {});

/// Returns the part of the directions around a point in which it meets the backs of surfaces.
///
/// Cost:    64 rays.
[[nodiscard]] double part_of_backs(const glm::vec3& point, const mesh::TriangleMesh& mesh,
                                   const RayScene& rays);

/// Returns how many points are inside of an object.
[[nodiscard]] std::size_t num_inside(const Receivers& receivers);

} // namespace relumine::prt
