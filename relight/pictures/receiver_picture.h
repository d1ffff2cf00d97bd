// Pictures from the light of receivers that are pixels or texels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/image/picture.h"
#include "mesh/opacity.h"
#include "prt/receivers/receiver_layout.h"
#include "relight/pictures/backdrop.h"

namespace relumine::relight {

using cubemap::Picture;

/// Composes the picture of pixel receivers without a background. Alpha is the mean opacity of a
/// pixel's samples, which is 0 for a sample without a receiver; the pixels are premultiplied.
///
/// Shape:   radiance is [num_receivers], opacity the same for each colour, or empty for opaque
///          receivers. It may be negative where light is added to what is behind. veils is
///          [num_receivers], or empty for receivers that nothing is seen through.
/// Throws:  std::invalid_argument for another number of values.
[[nodiscard]] Picture compose_cut_out(const prt::PixelLayout& layout,
                                      std::span<const glm::vec3> radiance,
                                      std::span<const glm::vec3> opacity = {},
                                      std::span<const mesh::Veil> veils = {});

/// Returns the derivative of a number by the radiance of pixel receivers, given that by the pixels
/// of compose_cut_out(): its transpose.
///
/// Shape:   weights is [height * width], the result [num_receivers].
/// Throws:  std::invalid_argument for another number of weights.
[[nodiscard]] std::vector<glm::vec3> cut_out_transpose(const prt::PixelLayout& layout,
                                                       std::span<const glm::vec3> weights,
                                                       std::span<const mesh::Veil> veils = {});

/// Composes the picture of pixel receivers before a backdrop: each pixel is the mean of its
/// samples. The picture is opaque.
///
/// Shape:   as compose_cut_out().
[[nodiscard]] Picture compose(const prt::PixelLayout& layout, std::span<const glm::vec3> radiance,
                              const Backdrop& backdrop, std::span<const glm::vec3> opacity = {},
                              std::span<const mesh::Veil> veils = {});

/// Composes the lightmap of texel receivers.
///
/// Texels around the charts are filled outwards, ring by ring up to `gutter` texels. Each takes the
/// mean of its eight neighbours that belong to earlier rings, so that filters near a chart's border
/// read its colours. Alpha is 1 where a chart touches the texel, 0 in the gutter and beyond.
///
/// Cost:    O(texels + filled texels).
[[nodiscard]] Picture compose(const prt::TexelLayout& layout, std::span<const glm::vec3> radiance,
                              std::uint32_t gutter = 16);

/// Composes the picture of points in space: one after the other, row by row. Alpha is 0 behind the
/// last one.
[[nodiscard]] Picture compose_rows(const prt::PlaceGrid& rows, std::span<const glm::vec3> radiance);

} // namespace relumine::relight
