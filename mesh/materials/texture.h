// Textures: images of eight bits per channel, and how they are looked up.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/materials/material.h"

namespace relumine::mesh {

/// The end of an image at which v is 0: OBJ counts from the bottom, glTF from the top.
enum class VOrigin : std::uint8_t { Bottom, Top };

/// An image in the orientation of the mesh's uvs. Row 0 is at v = 0, so a lookup needs no
/// convention.
struct Texture {
    /// Name of the file, or the name in the mesh file.
    std::string name;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    /// [height x width], rows along u, from v = 0 on.
    std::vector<std::array<std::uint8_t, 3>> texels;
    /// The image file that was decoded, and its end at v = 0. Empty for a texture that was
    /// computed.
    std::vector<std::byte> file = {};
    VOrigin origin = VOrigin::Top;

    bool operator==(const Texture&) const = default;
};

/// What all images of one mesh file may take: 256 MiB or 512 bytes for each byte of their files,
/// and no more than half of the memory that is free. So hostile files of kilobytes cannot cost
/// gigabytes.
class ImageBudget {
public:
    ImageBudget();
    /// Counts an image before its memory is taken. Returns whether it may be.
    [[nodiscard]] bool allows(std::uint64_t image_bytes, std::uint64_t file_bytes);

private:
    std::uint64_t image_bytes_ = 0, file_bytes_ = 0;
    std::uint64_t most_;
};

/// Decodes a PNG, JPEG, WebP, BMP or TGA file. Grey becomes RGB, alpha is dropped, 16 bits become
/// 8. `origin` is the end from which the mesh's uvs count.
///
/// Throws:  std::runtime_error "expected X, got Y" for a file that is no such image, is broken, or
///          declares more than 16384 x 16384 pixels, more than its bytes can hold or more than
///          the budget allows (mesh/materials/image_decoder.h).
[[nodiscard]] Texture decode_texture(std::span<const std::byte> file, VOrigin origin,
                                     ImageBudget& budget);

/// Decodes the alpha of an image, as grey: 255 if it has none.
/// Throws:  as decode_texture().
[[nodiscard]] Texture decode_alpha_texture(std::span<const std::byte> file, VOrigin origin,
                                           ImageBudget& budget);

/// Returns the value of a texel, each channel in [0, 1].
[[nodiscard]] glm::vec3 texel(const Texture& texture, std::uint32_t column, std::uint32_t row,
                              bool is_srgb);

/// Returns the tangent-space vector that a value of a normal map stands for, of any length. Bytes
/// of 127 and 128 both mean 0, so that a flat map is flat, and 255 means 1.
[[nodiscard]] glm::vec3 tangent_vector(const glm::vec3& texel);

/// The two texels of a coordinate, and the weight of the second.
struct TexelPair {
    std::uint32_t first, second;
    float weight;
};

/// Returns the texels beside a coordinate of a picture; texel centres lie at (i + 0.5) / size. A
/// coordinate that is not finite counts as 0.
[[nodiscard]] TexelPair texels_beside(float coordinate, std::uint32_t size, Wrap wrap);

/// Returns the bilinear value of a picture of some width and height, whose texels `texel(column,
/// row)` returns.
template<class Texel>
[[nodiscard]] glm::vec3 bilinear(const glm::vec2& uv, const std::array<std::uint32_t, 2>& size,
                                 const std::array<Wrap, 2>& wrap, const Texel& texel) {
    const TexelPair u = texels_beside(uv.x, size[0], wrap[0]);
    const TexelPair v = texels_beside(uv.y, size[1], wrap[1]);
    return glm::mix(glm::mix(texel(u.first, v.first), texel(u.second, v.first), u.weight),
                    glm::mix(texel(u.first, v.second), texel(u.second, v.second), u.weight),
                    v.weight);
}

/// Returns the texture's value at a uv of the mesh, each channel in [0, 1]. Values are bilinear
/// between texel centres, which lie at (i + 0.5) / width. A uv that is not finite counts as 0.
[[nodiscard]] glm::vec3 sample(const Texture& texture, const TextureSlot& slot,
                               const glm::vec2& mesh_uv);

} // namespace relumine::mesh
