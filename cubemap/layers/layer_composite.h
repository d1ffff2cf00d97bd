// Puts light layers over a base environment: over the whole map, or only where something changed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cubemap/cube_map.h"
#include "cubemap/layers/light_layer.h"
#include "cubemap/texel_rectangle.h"

namespace relumine::cubemap {

/// Returns rectangles that hold every texel the layer can change: at most eight per face, without
/// overlaps, none if the layer is off. It looks at no other layer: see without_solo() first. The
/// rectangles of a layer before and after an edit hold every texel that the edit changes.
///
/// Cost:    microseconds.
/// Throws:  std::invalid_argument as validate() does.
[[nodiscard]] std::vector<TexelRectangle> touched_texels(const LightLayer& layer,
                                                         std::uint32_t resolution);

/// Returns six rectangles that hold all texels of a cube map.
[[nodiscard]] std::vector<TexelRectangle> all_texels(std::uint32_t resolution);

/// Computes the texels of `target` in the rectangles: `base` with all layers over it, the first
/// layer lowest. Texels are computed from scratch, so errors do not add up over edits. A texel gets
/// a layer's mean coverage over the texel's solid angle, so the energy of a region depends neither
/// on R nor on the region's place.
///
/// A texel depends on `base` and the layers alone, bit by bit: neither the number of threads nor
/// the cut of the rectangles matters. `target` may be `base` itself if the rectangles do not
/// overlap; the layers then go over the texels that are there.
///
/// Threads: parallel (TBB).
/// Memory:  kilobytes per call for the layers' geometry, nothing per texel.
/// Throws:  std::invalid_argument for an invalid layer, maps of different resolutions or a
///          rectangle outside its face; nothing has changed then.
void composite(const CubeMap& base, std::span<const LightLayer> layers,
               std::span<const TexelRectangle> rectangles, CubeMap& target);

/// Returns the mean coverage of a region over each texel. An Emit layer of radiance 1 gives the
/// same values on a black map.
///
/// Shape:   [6 R R] in the order of a cube map's texels.
/// Throws:  std::invalid_argument as validate() does.
[[nodiscard]] std::vector<float> coverage_map(const Region& region, std::uint32_t resolution);

/// Returns the whole map `base` with all layers over it.
[[nodiscard]] CubeMap composite(const CubeMap& base, std::span<const LightLayer> layers);

} // namespace relumine::cubemap
