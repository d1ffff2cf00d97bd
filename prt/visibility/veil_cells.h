// How much light a surface with textures lets pass, place by place: one lookup for all of them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "mesh/materials/material.h"
#include "mesh/materials/texture.h"
#include "mesh/opacity.h"
#include "prt/visibility/texel_index.h"

namespace relumine::prt {

/// Returns the part of light that passes a veil. Alpha knows no colours, and neither do rays of
/// light.
[[nodiscard]] inline float part_of(const mesh::Veil& veil) {
    return (veil.through.r + veil.through.g + veil.through.b) / 3.0f;
}

/// The part of light that passes glass or what is blended, the mean over the colours, in cells of
/// up to 512 to a side of its textures. Rays of light pass by chance, so what counts are means over
/// many of them. A mask alone has MaskCells, which are exact.
class VeilCells {
public:
    /// Whether a material is such a surface and its textures all lie alike, so that a place is one
    /// for all.
    [[nodiscard]] static bool are_for(const mesh::Material& material);

    /// `material` as are_for() says.
    VeilCells(const mesh::Material& material, std::span<const mesh::Texture> textures);

    /// How the textures lie on a surface.
    [[nodiscard]] const mesh::TextureSlot& slot() const { return slot_; }

    /// Returns the part at a place of the textures.
    [[nodiscard]] float at(const glm::vec2& uv) const {
        return has_texel(uv) ? parts_[texel_index(uv, size_, slot_.wrap)] : 0.0f;
    }

private:
    mesh::TextureSlot slot_;
    std::array<std::uint32_t, 2> size_{};
    /// [height x width]
    std::vector<float> parts_;
};

} // namespace relumine::prt
