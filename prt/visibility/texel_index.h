// The texel of a texture that a place lies in.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <glm/vec2.hpp>

#include "mesh/materials/texture.h"

namespace relumine::prt {

/// Whether a place is near enough to the texture for texel_index().
[[nodiscard]] inline bool has_texel(const glm::vec2& uv) {
    constexpr float Farthest = 1e6f;
    return std::abs(uv.x) < Farthest && std::abs(uv.y) < Farthest;
}

/// Returns the texel that has a coordinate. The two of a bilinear lookup are this one and a
/// neighbour.
[[nodiscard]] inline std::uint32_t nearest_texel(float x, std::uint32_t size, mesh::Wrap wrap) {
    const auto towards_zero = static_cast<int>(x);
    const int below = towards_zero - (static_cast<float>(towards_zero) > x ? 1 : 0);
    if (wrap == mesh::Wrap::Clamp)
        x = std::clamp(x, 0.0f, 1.0f);
    else {
        x -= static_cast<float>(below);
        if (wrap == mesh::Wrap::Mirror && (below & 1) != 0)
            x = 1.0f - x;
    }
    return std::min(static_cast<std::uint32_t>(x * static_cast<float>(size)), size - 1);
}

/// Returns the number of the texel, row by row, that a place lies in.
[[nodiscard]] inline std::size_t texel_index(const glm::vec2& uv,
                                             const std::array<std::uint32_t, 2>& size,
                                             const std::array<mesh::Wrap, 2>& wrap) {
    return std::size_t{nearest_texel(uv.y, size[1], wrap[1])} * size[0] +
           nearest_texel(uv.x, size[0], wrap[0]);
}

} // namespace relumine::prt
