#include "mesh/materials/texture.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "files/avif_decoder.h"
#include "files/free_memory.h"
#include "files/pixel_values.h"
#include "mesh/materials/image_decoder.h"

namespace relumine::mesh {

namespace {

using Channels = std::array<std::uint8_t, 3>;

std::array<float, 256> srgb_table() {
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i)
        table[i] = static_cast<float>(files::linear_of_srgb(static_cast<double>(i) / 255.0));
    return table;
}

glm::vec3 decoded(const Channels& texel, bool is_srgb) {
    static const std::array<float, 256> srgb = srgb_table();
    if (is_srgb)
        return {srgb[texel[0]], srgb[texel[1]], srgb[texel[2]]};
    return glm::vec3(texel[0], texel[1], texel[2]) / 255.0f;
}

/// std::floor(), which is a call where a processor need not have an instruction for it.
double whole_below(double x) {
    constexpr double Whole = 0x1p52; // from here on all are
    if (!(std::abs(x) < Whole))
        return x;
    const auto towards_zero = static_cast<double>(static_cast<std::int64_t>(x));
    return towards_zero > x ? towards_zero - 1.0 : towards_zero;
}

/// Returns the texel for an integer coordinate that may lie outside 0..size-1.
std::uint32_t wrapped(std::int64_t i, std::uint32_t size, Wrap wrap) {
    const std::int64_t n = size;
    if (i >= 0 && i < n) // as nearly all do: a division takes as long as the rest of a lookup
        return static_cast<std::uint32_t>(i);
    if (wrap == Wrap::Clamp)
        return static_cast<std::uint32_t>(std::clamp<std::int64_t>(i, 0, n - 1));
    const std::int64_t period = wrap == Wrap::Mirror ? 2 * n : n;
    i = (i % period + period) % period;
    return static_cast<std::uint32_t>(i < n ? i : period - 1 - i);
}

/// Puts the image's rows into the order of v. `texel` gives the pixel of a number from the top
/// left.
template<class Texel>
Texture in_rows_of_v(const DecodedImage& image, VOrigin origin, const Texel& texel) {
    Texture texture;
    texture.width = image.width;
    texture.height = image.height;
    texture.texels.resize(std::size_t{texture.width} * texture.height);
    for (std::size_t row = 0; row < texture.height; ++row) {
        const std::size_t from = origin == VOrigin::Top ? row : texture.height - 1 - row;
        for (std::size_t column = 0; column < texture.width; ++column)
            texture.texels[row * texture.width + column] = texel(from * texture.width + column);
    }
    return texture;
}

} // namespace

ImageBudget::ImageBudget() : most_(files::free_memory() / 2) {}

bool ImageBudget::allows(std::uint64_t image_bytes, std::uint64_t file_bytes) {
    constexpr std::uint64_t Cheap = std::uint64_t{1} << 28, PerByte = 512;
    image_bytes_ += image_bytes;
    file_bytes_ += file_bytes;
    return image_bytes_ <= std::min(std::max(Cheap, PerByte * file_bytes_), most_);
}

Texture decode_texture(std::span<const std::byte> file, VOrigin origin, ImageBudget& budget) {
    const DecodedImage image = decode_image(file, budget);
    Texture texture = in_rows_of_v(image, origin, [&](std::size_t pixel) {
        Channels texel{};
        std::memcpy(texel.data(), image.bytes.get() + 3 * pixel, texel.size());
        return texel;
    });
    // Not every build reads AVIF: scene files get the texels.
    if (!files::is_avif(file))
        texture.file.assign(file.begin(), file.end());
    texture.origin = origin;
    return texture;
}

Texture decode_alpha_texture(std::span<const std::byte> file, VOrigin origin, ImageBudget& budget) {
    const DecodedImage image = decode_alpha(file, budget);
    return in_rows_of_v(image, origin, [&](std::size_t pixel) {
        const std::uint8_t alpha = image.bytes.get()[pixel];
        return Channels{alpha, alpha, alpha};
    });
}

glm::vec3 texel(const Texture& texture, std::uint32_t column, std::uint32_t row, bool is_srgb) {
    return decoded(texture.texels[std::size_t{row} * texture.width + column], is_srgb);
}

glm::vec3 tangent_vector(const glm::vec3& texel) {
    const auto component = [](float channel) {
        const float value = 2.0f * channel - 1.0f, step = 1.0f / 255.0f;
        const float length = std::max(std::abs(value) - step, 0.0f) / (1.0f - step);
        return std::copysign(length < 1e-6f ? 0.0f : length, value);
    };
    return {component(texel.x), component(texel.y), std::max(component(texel.z), 0.0f)};
}

TexelPair texels_beside(float coordinate, std::uint32_t size, Wrap wrap) {
    // In double. A repeating coordinate is first brought near 0, so large coordinates keep the
    // fraction that their float has.
    double x = std::isfinite(coordinate) ? double{coordinate} : 0.0;
    x = wrap == Wrap::Clamp ? std::clamp(x, 0.0, 1.0) : x - 2.0 * whole_below(0.5 * x);
    x = x * size - 0.5;
    const double below = whole_below(x);
    const auto i = static_cast<std::int64_t>(below);
    return {wrapped(i, size, wrap), wrapped(i + 1, size, wrap), static_cast<float>(x - below)};
}

glm::vec3 sample(const Texture& texture, const TextureSlot& slot, const glm::vec2& mesh_uv) {
    return bilinear(slot.uv_from_mesh_uv * mesh_uv + slot.uv_offset,
                    {texture.width, texture.height}, slot.wrap,
                    [&](std::uint32_t column, std::uint32_t row) {
                        return texel(texture, column, row, slot.is_srgb);
                    });
}

} // namespace relumine::mesh
