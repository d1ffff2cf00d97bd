// Receivers of image relighting [JN, Section 3.1]: the points that a fixed camera sees.
#pragma once

#include <optional>

#include "mesh/triangle_mesh.h"
#include "prt/receivers/receiver_layout.h"
#include "prt/receivers/receivers.h"
#include "prt/visibility/ray_scene.h"
#include "prt/work.h"

namespace relumine::prt {

/// A picture to be relit.
struct PixelView {
    Camera camera = {};
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    /// n: each pixel has n x n samples. None: see pixel_receivers().
    std::optional<std::uint32_t> samples_per_axis = 1;
};

struct PixelReceivers {
    Receivers receivers;
    PixelLayout layout;
};

/// Returns the first hits of the view's rays, with their directions to the eye and their points on
/// the mesh, and all that is seen through what is thin. A sample that hits nothing makes no
/// receiver.
///
/// Without a number of samples a pixel has one receiver where its middle and its corners see the
/// same surface. Others, where edges and outlines are, have 4 x 4 samples, and a receiver for each
/// surface that these see (PixelLayout::shares).
///
/// The normal is the interpolated vertex normal, turned over where the eye sees the back of the
/// surface. The vertex normals say which side is the front; the order of a triangle's corners does
/// not.
///
/// Cost:    one ray per sample, or two per pixel and 16 at edges; parallel over rows.
/// Throws:  std::invalid_argument as PictureRays does, for more than MaxLayoutPlaces samples and
///          for a view that sees nothing of the mesh; Cancelled.
[[nodiscard]] PixelReceivers pixel_receivers(const mesh::TriangleMesh& mesh, const RayScene& rays,
                                             const PixelView& view, const Work& work = {});

} // namespace relumine::prt
