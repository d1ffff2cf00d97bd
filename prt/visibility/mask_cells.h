// Where an alpha mask is all there or all cut out, texel by texel: most lookups need no more.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

#include "mesh/materials/material.h"
#include "mesh/materials/texture.h"

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
        if (!(std::abs(uv.x) < Farthest && std::abs(uv.y) < Farthest))
            return Cell::Mixed;
        return cells_[std::size_t{nearest(uv.y, 1)} * size_[0] + nearest(uv.x, 0)];
    }

private:
    static constexpr float Farthest = 1e6f;

    /// The texel that has a coordinate. The two of a bilinear lookup are this one and a neighbour.
    [[nodiscard]] std::uint32_t nearest(float x, std::size_t axis) const {
        const auto towards_zero = static_cast<int>(x);
        const int below = towards_zero - (static_cast<float>(towards_zero) > x ? 1 : 0);
        if (slot_.wrap[axis] == mesh::Wrap::Clamp)
            x = std::clamp(x, 0.0f, 1.0f);
        else {
            x -= static_cast<float>(below);
            if (slot_.wrap[axis] == mesh::Wrap::Mirror && (below & 1) != 0)
                x = 1.0f - x;
        }
        return std::min(static_cast<std::uint32_t>(x * static_cast<float>(size_[axis])),
                        size_[axis] - 1);
    }

    mesh::TextureSlot slot_;
    float alpha_, cutoff_;
    std::array<std::uint32_t, 2> size_;
    /// [height x width] of the texel and its eight neighbours: the four of a lookup inside of it
    /// are among them, however the texture is wrapped.
    std::vector<Cell> cells_;
};

} // namespace relumine::prt
