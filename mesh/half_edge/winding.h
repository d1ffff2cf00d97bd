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
/// all others. A patch that is closed, or nearly so, faces outwards; inside an odd number of other
/// closed patches it faces inwards, as the inner wall of a bottle does. An open patch keeps the
/// winding that most of its area has.
///
/// Vertices at equal positions count as one.
///
/// Cost:    O(n log n), and O(patches that lie inside of each other's box times their triangles).
[[nodiscard]] Winding find_winding(const TriangleMesh& mesh);

/// Whether the normals of a triangle's vertices stand on the side from which its corners run
/// counter-clockwise, or at least not all of them on the other.
[[nodiscard]] bool faces_with_normals(const TriangleMesh& mesh, std::uint32_t triangle);

} // namespace relumine::mesh
