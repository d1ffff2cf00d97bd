// Pictures out of the light of receivers that are pixels or texels.
#pragma once

#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "prt/receivers/receiver_layout.h"
#include "relight/pictures/picture.h"

namespace relumine::relight {

/// The picture that pixel receivers are: each pixel the mean of its samples, those without a
/// receiver showing the environment in their ray's direction. Opaque. `radiance`: [num_receivers].
/// Throws std::invalid_argument for another number or a background without texels.
[[nodiscard]] Picture compose(const prt::PixelLayout& layout, std::span<const glm::vec3> radiance,
                              const cubemap::CubeMap& background);

/// The same without a background: its samples are black, alpha is the share of samples with a
/// receiver (coverage), so that the pixels are premultiplied.
[[nodiscard]] Picture compose_cut_out(const prt::PixelLayout& layout,
                                      std::span<const glm::vec3> radiance);

/// The lightmap that texel receivers are. Texels around the charts are filled outwards, ring by
/// ring up to `gutter` texels, each with the mean of its neighbours of the ring before (of eight),
/// so that filters near a chart's border read its colours. Alpha is 1 where a chart touches the
/// texel, 0 in the gutter and beyond. O(texels + filled ones).
[[nodiscard]] Picture compose(const prt::TexelLayout& layout, std::span<const glm::vec3> radiance,
                              std::uint32_t gutter = 16);

} // namespace relumine::relight
