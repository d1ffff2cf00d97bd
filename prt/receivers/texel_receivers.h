// Receivers of a lightmap: the texels of an atlas that the mesh's uvs touch.
#pragma once

#include <cstddef>
#include <cstdint>

#include "mesh/triangle_mesh.h"
#include "prt/receivers/receiver_layout.h"
#include "prt/receivers/receivers.h"

namespace relumine::prt {

/// The size of a lightmap.
struct AtlasSize {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
};

/// A limit on texels, which bounds what is allocated: 8192 x 8192, more than any lightmap has.
inline constexpr std::size_t MaxTexels = std::size_t{1} << 26;

/// How well the uvs fit the atlas.
struct AtlasReport {
    /// Texels whose centre is inside several triangles.
    std::size_t num_overlapping = 0;
    /// The first overlapping texel, row by row from the top.
    std::uint32_t first_overlap = 0;
    /// Texels that a chart touches without covering their centre.
    std::size_t num_borders = 0;
    /// Triangles without an area in uv, which get no texels.
    std::size_t num_flat = 0;
    /// Triangles that reach beyond 0..1 and are cut off there.
    std::size_t num_outside = 0;
};

struct TexelReceivers {
    Receivers receivers;
    TexelLayout layout;
    AtlasReport report;
};

/// Returns one receiver for each texel that shares an area with a triangle in uv.
///
/// Where the texel's centre is inside a triangle, the receiver is that point of the mesh; the first
/// of several triangles counts. Elsewhere the receiver is the nearest point of the triangles that
/// touch the texel; the first of equally near ones counts. The normal is the interpolated vertex
/// normal.
///
/// `uv_set` 1: the mesh's second uvs count.
///
/// Cost:    O(texels in the boxes around the triangles).
/// Throws:  std::invalid_argument for a mesh without uvs; for a size of 0, above MaxPictureSize a
///          side or above MaxTexels in all; for uvs that touch no texel.
[[nodiscard]] TexelReceivers texel_receivers(const mesh::TriangleMesh& mesh, const AtlasSize& size,
                                             std::uint32_t uv_set = 0);

} // namespace relumine::prt
