// Textures: images of eight bits a channel and how they are looked up.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/material.h"

namespace relumine::mesh {

/// Which end of an image v = 0 is: OBJ counts from the bottom, glTF from the top.
enum class VOrigin : std::uint8_t { Bottom, Top };

/// An image in the orientation of the mesh's uvs: row 0 is at v = 0, so that a lookup needs no
/// convention.
struct Texture {
    /// Its file, or what the mesh file calls it
    std::string name;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    /// [height x width], rows of u from v = 0 on
    std::vector<std::array<std::uint8_t, 3>> texels;

    bool operator==(const Texture&) const = default;
};

/// Decodes a PNG, JPEG, BMP or TGA file; grey becomes RGB, alpha is dropped, 16 bits become 8.
/// `origin` is what the mesh's uvs count from. Throws std::runtime_error "expected X, got Y" for
/// what is no such image, is broken, or declares more than 16384 x 16384 pixels or than its bytes
/// can hold (mesh/image_decoder.h).
[[nodiscard]] Texture decode_texture(std::span<const std::byte> file, VOrigin origin);

/// The texture's value at a uv of the mesh, each channel 0..1: bilinear between texel centres,
/// which lie at (i + 0.5) / width. A uv that is not finite counts as 0.
[[nodiscard]] glm::vec3 sample(const Texture& texture, const TextureSlot& slot,
                               const glm::vec2& mesh_uv);

} // namespace relumine::mesh
