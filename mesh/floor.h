// The ground plane under a mesh.
#pragma once

#include <cstdint>
#include <span>

#include <glm/vec2.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Appends a square grid of n x n vertices that faces +Y. The grid is centred under the mesh's
/// bounding box. Its sides are `scale` times the larger horizontal extent of the box or half its
/// height, whichever is more, or times its diagonal if there is no horizontal extent. Rows and
/// columns are 2.5 times as dense in the middle as even ones, and half as dense at the edge.
///
/// The floor lies a hair below the mesh's lowest point, so that it shares no plane with a face: by
/// 1/5000 of the diagonal of all, which is twice the lift of rays, and more where floats are
/// sparse.
///
/// The mesh's own vertices keep their places. The floor's vertices follow, rows along +X, row after
/// row along +Z. Arrays that the mesh has are extended: normals by (0, 1, 0), colours by white, uvs
/// by (0, 0), materials by a white Lambert one named "floor". The floor is a group "floor" of its
/// own; a mesh without groups becomes a group "mesh".
///
/// n = 193 has as many vertices as the floor of [JN] Table 1: 37,249.
///
/// Throws:  std::invalid_argument for n < 2, a mesh without extent, a scale that is not positive,
///          and a floor that needs more than 32-bit indices or float coordinates.
void append_floor(TriangleMesh& mesh, std::uint32_t n = 193, float scale = 4.0f);

/// Returns how far an added floor, whose vertices begin at `first`, lies below what stands flat on
/// it; 0 where nothing does. Eyes that look down on the floor see it raised by so much: they would
/// look into the gap.
[[nodiscard]] float floor_gap(const TriangleMesh& mesh, std::size_t first);

/// Returns what an eye's rays need of a mesh, with its added floor raised.
[[nodiscard]] TriangleMesh with_raised_floor(const TriangleMesh& mesh, std::size_t first,
                                             float gap);

/// Where an added floor lies.
struct FloorPlace {
    /// x and z.
    glm::vec2 center{0.0f};
    float half_side = 0.0f;
    /// Between neighbouring rows in the middle and at the edge.
    float spacing_inside = 0.0f, spacing_outside = 0.0f;
};

/// Returns the place of a floor of n x n vertices, which are given. n is at least 2.
[[nodiscard]] FloorPlace floor_place(std::span<const glm::vec3> positions, std::uint32_t n);

} // namespace relumine::mesh
