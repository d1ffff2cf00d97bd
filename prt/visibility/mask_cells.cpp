#include "prt/visibility/mask_cells.h"

#include <algorithm>
#include <cstddef>

#include "files/parallel.h"

namespace relumine::prt {

namespace {

/// Neighbours on either side, at an edge as the texture is wrapped: the texel itself, or that of
/// the other edge.
std::array<std::uint32_t, 3> beside(std::uint32_t i, std::uint32_t size, mesh::Wrap wrap) {
    if (wrap == mesh::Wrap::Repeat)
        return {(i + size - 1) % size, i, (i + 1) % size};
    return {i - (i > 0 ? 1u : 0u), i, std::min(i + 1, size - 1)};
}

} // namespace

MaskCells::MaskCells(const mesh::Material& material, const mesh::Texture& texture)
    : slot_(*material.alpha_texture), alpha_(material.alpha), cutoff_(material.alpha_cutoff),
      size_{texture.width, texture.height} {
    constexpr float OfMean = 1e-5f; // of the bilinear mean
    const auto [width, height] = size_;
    const auto kind = [&](std::uint8_t value) {
        const mesh::Texture one{.name = {}, .width = 1, .height = 1, .texels = {{value, 0, 0}}};
        const float alpha = alpha_ * mesh::texel(one, 0, 0, slot_.is_srgb).r;
        return alpha >= cutoff_ + OfMean  ? Cell::There
               : alpha < cutoff_ - OfMean ? Cell::CutOut
                                          : Cell::Mixed;
    };
    std::array<Cell, 256> kinds{};
    for (std::size_t value = 0; value < kinds.size(); ++value)
        kinds[value] = kind(static_cast<std::uint8_t>(value));
    cells_.resize(texture.texels.size());
    const auto of = [&](std::uint32_t column, std::uint32_t row) {
        return kinds[texture.texels[std::size_t{row} * size_[0] + column][0]];
    };
    files::parallel_for(
        std::uint32_t{0}, height, [&, across = width, down = height](std::uint32_t y) {
            for (std::uint32_t x = 0; x < across; ++x) {
                Cell cell = of(x, y);
                for (const std::uint32_t row : beside(y, down, slot_.wrap[1]))
                    for (const std::uint32_t column : beside(x, across, slot_.wrap[0]))
                        if (of(column, row) != cell)
                            cell = Cell::Mixed;
                cells_[std::size_t{y} * across + x] = cell;
            }
        });
}

bool MaskCells::are_of(const mesh::Material& material) const {
    const mesh::TextureSlot& slot = *material.alpha_texture;
    return slot.texture == slot_.texture && slot.wrap == slot_.wrap &&
           slot.is_srgb == slot_.is_srgb && material.alpha == alpha_ &&
           material.alpha_cutoff == cutoff_;
}

} // namespace relumine::prt
