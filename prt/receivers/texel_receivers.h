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

/// More texels than any lightmap has (8192 x 8192); it bounds what is allocated.
inline constexpr std::size_t MaxTexels = std::size_t{1} << 26;

/// How the uvs fit the atlas.
struct AtlasReport {
    /// Texels whose centre is inside several triangles
    std::size_t num_overlapping = 0;
    /// The first of them, row by row from the top
    std::uint32_t first_overlap = 0;
    /// Texels that a chart touches but whose centre it leaves out
    std::size_t num_borders = 0;
    /// Triangles without an area in uv; they get no texels
    std::size_t num_flat = 0;
    /// Triangles that reach beyond 0..1; cut off there
    std::size_t num_outside = 0;
};

struct TexelReceivers {
    Receivers receivers;
    TexelLayout layout;
    AtlasReport report;
};

/// One receiver for each texel that shares an area with a triangle in uv: where the texel's centre
/// is inside a triangle, that point of the mesh (of several triangles the first); else the nearest
/// point of those triangles (of the first, where they are equally near). The normal is the
/// interpolated vertex normal. O(texels in the boxes around the triangles). Throws
/// std::invalid_argument for a mesh without uvs, a size of 0, above MaxPictureSize a side or
/// MaxTexels in all, and for uvs that touch no texel.
[[nodiscard]] TexelReceivers texel_receivers(const mesh::TriangleMesh& mesh, const AtlasSize& size);

} // namespace relumine::prt
