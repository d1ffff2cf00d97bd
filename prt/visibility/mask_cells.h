// Where an alpha mask is all there or all cut out, texel by texel: most lookups need no more.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

#include "mesh/materials/material.h"
#include "mesh/materials/texture.h"
#include "prt/visibility/texel_index.h"

namespace relumine::prt {

/// What lookups of a mask between texel centres find.
class MaskCells {
public:
    enum class Cell : std::uint8_t { Mixed, There, CutOut };

    /// `material` has a mask with a texture.
    MaskCells(const mesh::Material& material, const mesh::Texture& texture);

    /// Whether another material's cells would be the same.
    [[nodiscard]] bool are_of(const mesh::Material& material) const;

    /// Says what the alpha at a uv of the texture is. A lookup decides where it is mixed.
    [[nodiscard]] Cell at(const glm::vec2& uv) const {
        if (!has_texel(uv))
            return Cell::Mixed;
        return cells_[texel_index(uv, size_, slot_.wrap)];
    }

private:
    mesh::TextureSlot slot_;
    float alpha_, cutoff_;
    std::array<std::uint32_t, 2> size_;
    /// [height x width] of the texel and its eight neighbours: the four of a lookup inside of it
    /// are among them, however the texture is wrapped.
    std::vector<Cell> cells_;
};

} // namespace relumine::prt
