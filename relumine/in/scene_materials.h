// The materials that a scene keeps for its pictures.
#pragma once

#include "mesh/triangle_mesh.h"
#include "prt/glossy/surface_sampling.h"
#include "prt/receivers/receivers.h"

namespace relumine {

/// Pictures take the light of the vertices, and the colours of textures and the highlights from the
/// materials. So surfaces that replace those of the file become materials, and black vertices keep
/// a trace by which their light is known: the lowest value that an image of 8 bits has.
///
/// `receivers` are the vertices, or points with the vertices behind them, which mirrors show, with
/// their surfaces; `are_replaced` says whether `surface_of` gives other surfaces than the
/// materials. Nothing changes where no picture asks for materials.
void keep_materials(mesh::TriangleMesh& mesh, prt::Receivers& receivers,
                    const prt::SurfaceOverride& surface_of, bool are_replaced);

} // namespace relumine
