// Puts light layers over a base environment, whole or only where something changed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cubemap/cube_map.h"
#include "cubemap/layers/light_layer.h"
#include "cubemap/texel_rectangle.h"

namespace relumine::cubemap {

/// At most eight rectangles per face that hold every texel the layer can change, without overlaps;
/// none if the layer is off. After an edit, the rectangles of the layer as it was and as it is hold
/// every texel that changed. Microseconds. Throws std::invalid_argument like validate().
[[nodiscard]] std::vector<TexelRectangle> touched_texels(const LightLayer& layer,
                                                         std::uint32_t resolution);

/// All texels of a cube map: six rectangles.
[[nodiscard]] std::vector<TexelRectangle> all_texels(std::uint32_t resolution);

/// Makes the texels of `target` in the rectangles what `base` with all layers over it, the first
/// lowest, is there: from scratch, so that nothing adds up over edits. A texel gets a layer's mean
/// coverage over its solid angle, so a region's energy depends neither on R nor on its place.
///
/// Parallel (TBB). A texel depends on `base` and the layers alone, bit by bit: not on threads, nor
/// on how rectangles are cut or overlap. `target` may be `base` itself if the rectangles do not
/// overlap: the layers then go over what is there. Allocates what the layers' geometry needs once
/// per call (kilobytes), nothing per texel. Throws std::invalid_argument before anything has
/// changed for an invalid layer, maps of different resolutions or a rectangle that is not inside
/// its face.
void composite(const CubeMap& base, std::span<const LightLayer> layers,
               std::span<const TexelRectangle> rectangles, CubeMap& target);

/// Mean coverage of a region over each texel, [6 R R] as a cube map's texels; on black, what an
/// Emit layer of radiance 1 makes them. Throws like validate().
[[nodiscard]] std::vector<float> coverage_map(const Region& region, std::uint32_t resolution);

/// The one-call form: the whole map.
[[nodiscard]] CubeMap composite(const CubeMap& base, std::span<const LightLayer> layers);

} // namespace relumine::cubemap
