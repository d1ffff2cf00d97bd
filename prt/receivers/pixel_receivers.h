// Receivers of image relighting [JN, Section 3.1]: what a fixed camera sees.
#pragma once

#include "mesh/triangle_mesh.h"
#include "prt/receivers/receiver_layout.h"
#include "prt/receivers/receivers.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::prt {

/// A picture to be relit.
struct PixelView {
    Camera camera = {};
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    /// n x n samples a pixel
    std::uint32_t samples_per_axis = 1;
};

struct PixelReceivers {
    Receivers receivers;
    PixelLayout layout;
};

/// The first hits of the view's rays, with their direction to the eye and their place on the mesh;
/// samples that hit nothing are no receivers. The normal is the interpolated vertex normal, turned
/// over where the eye sees the back of the surface (vertex normals, not the order of a triangle's
/// corners, say which side is the front). Parallel over rows; one ray per sample. Throws
/// std::invalid_argument as PictureRays does, for more than MaxLayoutPlaces samples and for a view
/// that sees nothing of the mesh.
[[nodiscard]] PixelReceivers pixel_receivers(const mesh::TriangleMesh& mesh, const RayScene& rays,
                                             const PixelView& view);

} // namespace relumine::prt
