// What the samples of a picture's pixels see.
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/opacity.h"
#include "mesh/triangle_mesh.h"
#include "prt/receivers/mesh_point.h"
#include "prt/receivers/pixel_receivers.h"
#include "prt/visibility/ray_scene.h"
#include "prt/work.h"

namespace relumine::prt {

/// A surface that samples of a pixel see.
struct SeenSurface {
    std::uint32_t sample;
    MeshPoint point;
    mesh::Veil veil = {};
    /// PixelLayout::shares.
    std::uint16_t share = 1;
    /// Receivers::normal_spread.
    float normal_spread = 0.0f;
};

/// Returns what the samples of each row of pixels see, ascending: the first surface, or all that a
/// thin one lets through. Samples share a surface where the view has no number of samples.
[[nodiscard]] std::vector<std::vector<SeenSurface>> seen_rows(const mesh::TriangleMesh& mesh,
                                                              const RayScene& rays,
                                                              const PixelView& view,
                                                              const Work& work);

} // namespace relumine::prt
