// Which triangles are wound the wrong way round.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

struct Winding {
    /// [num_triangles] triangles that must turn for a winding that is consistent and outward.
    std::vector<bool> is_wrong;
    std::size_t num_wrong = 0;
    /// The first of them.
    std::uint32_t first_wrong = 0;
    /// Edges whose two triangles go the same way and would after any turning: the surface has one
    /// side only.
    std::size_t num_one_sided = 0;
};

/// Finds the triangles that are wound the wrong way round.
///
/// Triangles that share an edge with one another alone form a patch, in which one winding decides
/// all others. A patch that is closed, or nearly so, faces outwards, unless it is a room: it faces
/// inwards as a whole, and closed patches inside of it face outwards. Patches just inside of a room
/// face outwards. All others, inside of closed ones or open, keep the winding that most of their
/// area has: they may be the inner wall of a bottle, or a ball in a case.
///
/// Vertices at equal positions count as one.
///
/// Cost:    O(n log n), and O(patches that lie inside of each other's box times their triangles).
[[nodiscard]] Winding find_winding(const TriangleMesh& mesh);

/// Whether the normals of a triangle's vertices stand on the side from which its corners run
/// counter-clockwise, or at least not all of them on the other.
[[nodiscard]] bool faces_with_normals(const TriangleMesh& mesh, std::uint32_t triangle);

/// Winds a triangle the other way round.
void turn_triangle(TriangleMesh& mesh, std::uint32_t triangle);

/// Makes winding and normals agree in each patch that has them against each other on most of its
/// area, and shares no vertex with another one. Where find_winding() says which way the patch
/// faces, whichever is wrong is turned. Else the triangles are, since normals decide the light.
/// mesh.warnings has a line for either.
///
/// Cost:    as find_winding(), and O(n) where all agree.
void settle_normals(TriangleMesh& mesh);

} // namespace relumine::mesh
