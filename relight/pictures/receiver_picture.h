// Pictures from the light of receivers that are pixels or texels.
#pragma once

#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "prt/receivers/receiver_layout.h"
#include "relight/pictures/picture.h"

namespace relumine::relight {

/// Composes the picture of pixel receivers: each pixel is the mean of its samples. A sample without
/// a receiver shows the environment in its ray's direction. The picture is opaque.
///
/// Shape:   radiance is [num_receivers].
/// Throws:  std::invalid_argument for another number of values, or a background without texels.
[[nodiscard]] Picture compose(const prt::PixelLayout& layout, std::span<const glm::vec3> radiance,
                              const cubemap::CubeMap& background);

/// Composes the picture of pixel receivers without a background. Samples without a receiver are
/// black. Alpha is the share of samples with a receiver (coverage), so the pixels are
/// premultiplied.
[[nodiscard]] Picture compose_cut_out(const prt::PixelLayout& layout,
                                      std::span<const glm::vec3> radiance);

/// Composes the lightmap of texel receivers.
///
/// Texels around the charts are filled outwards, ring by ring up to `gutter` texels. Each takes the
/// mean of its eight neighbours that belong to earlier rings, so that filters near a chart's border
/// read its colours. Alpha is 1 where a chart touches the texel, 0 in the gutter and beyond.
///
/// Cost:    O(texels + filled texels).
[[nodiscard]] Picture compose(const prt::TexelLayout& layout, std::span<const glm::vec3> radiance,
                              std::uint32_t gutter = 16);

} // namespace relumine::relight
