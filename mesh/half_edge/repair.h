// Mends what the mesh doctor finds.
#pragma once

#include <cstddef>
#include <cstdint>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

struct RepairOptions {
    /// Vertices at equal positions and of equal colours become one. Where their uvs differ, the
    /// corners of the triangles keep them.
    bool weld = false;
    /// Holes with rims of at most so many edges are closed, without new vertices and with the least
    /// area (G. Barequet, M. Sharir: Filling Gaps in the Boundary of a Polyhedron, 1995). A rim
    /// whose lid would have more than half of the surface's area is no hole, and stays. 0: none.
    std::uint32_t fill_holes = 0;
};

/// The longest rim that fill_holes may name: the work grows with its third power.
inline constexpr std::uint32_t LongestRim = 1000;

/// What repair() changed.
struct RepairReport {
    std::size_t num_welded = 0;
    std::size_t num_zero_area = 0;
    std::size_t num_duplicates = 0;
    std::size_t num_turned = 0;
    std::size_t num_filled = 0;
    std::size_t num_new_triangles = 0;

    [[nodiscard]] bool is_nothing() const {
        return num_welded + num_zero_area + num_duplicates + num_turned + num_filled == 0;
    }
};

/// Drops triangles without area and triangles with the same vertices as an earlier one; where two
/// of them are wound against each other and the surface goes on without them on all sides, they are
/// a fold, and both go. Turns triangles that are wound the wrong way round (find_winding()). Before
/// that it welds, after that it closes holes, where the options say so. Nothing else changes:
/// vertices keep order and positions, and normals are computed again only at vertices whose
/// triangles changed. A second repair with the same options changes nothing.
///
/// Throws:  std::runtime_error "expected X, got Y" where nothing would remain, and where a rim that
///          fill_holes asks for runs through a vertex or an edge that the surface meets twice;
///          std::invalid_argument for a rim longer than LongestRim.
/// Cost:    O(n log n), and O(edges^3) for each hole.
[[nodiscard]] TriangleMesh repair(const TriangleMesh& mesh, const RepairOptions& options = {},
                                  RepairReport* report = nullptr);

} // namespace relumine::mesh
