// Surfaces without thickness that are lit from both sides.
#pragma once

#include "mesh/triangle_mesh.h"
#include "prt/visibility/blockers.h"
#include "prt/work.h"

namespace relumine::prt {

/// Appends the backs of triangles that light from outside reaches from behind: the same corners as
/// vertices of their own, with normals turned over. Vertices and triangles of the mesh come first.
/// A leaf of one triangle has a back, too: it is seen from both sides. So has a closed surface that
/// is wound the wrong way round. One that faces outwards gets none, nor do triangles that the mesh
/// has for both sides (prt::TwinTriangles), nor bodies of glass. Where an eye sees through a
/// material, all of its triangles get their backs if one does, and the material has one side
/// afterwards.
///
/// Cost:    O(n log n), and four points to trace for each triangle, more where it is large in the
///          scene.
/// Threads: parallel inside; the result is the same for any number of threads.
/// Throws:  Cancelled.
[[nodiscard]] mesh::TriangleMesh with_lit_backs(const mesh::TriangleMesh& mesh,
                                                const Blockers& blockers, float bias,
                                                const Work& work = {});

/// Appends the backs of triangles that pass light on from one side to the other
/// (passes_light_on()) and that the mesh has for one side only, as with_lit_backs() does: the light
/// of either side is then that of receivers. Materials that do so have one side afterwards, so that
/// an eye meets one of the two.
///
/// Cost:    O(n log n).
[[nodiscard]] mesh::TriangleMesh with_backs_of_sheets(const mesh::TriangleMesh& mesh);

} // namespace relumine::prt
