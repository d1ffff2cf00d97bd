#include "mesh/texture.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <stb/stb_image.h> // Debian's libstb is compiled

namespace relumine::mesh {

namespace {

using Channels = std::array<std::uint8_t, 3>;

/// IEC 61966-2-1.
std::array<float, 256> srgb_table() {
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
        const double s = static_cast<double>(i) / 255.0;
        table[i] = static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
    }
    return table;
}

glm::vec3 decoded(const Channels& texel, bool is_srgb) {
    static const std::array<float, 256> srgb = srgb_table();
    if (is_srgb)
        return {srgb[texel[0]], srgb[texel[1]], srgb[texel[2]]};
    return glm::vec3(texel[0], texel[1], texel[2]) / 255.0f;
}

/// The texel that a whole coordinate outside 0..size-1 means.
std::uint32_t wrapped(std::int64_t i, std::uint32_t size, Wrap wrap) {
    const std::int64_t n = size;
    if (wrap == Wrap::Clamp)
        return static_cast<std::uint32_t>(std::clamp<std::int64_t>(i, 0, n - 1));
    const std::int64_t period = wrap == Wrap::Mirror ? 2 * n : n;
    i = (i % period + period) % period;
    return static_cast<std::uint32_t>(i < n ? i : period - 1 - i);
}

/// A coordinate's two texels and the weight of the second.
struct Pair {
    std::uint32_t first, second;
    float weight;
};

Pair neighbours(float coordinate, std::uint32_t size, Wrap wrap) {
    // In double, and brought near 0 first, where it repeats: large coordinates keep their fraction as far as float has it.
    double x = std::isfinite(coordinate) ? double{coordinate} : 0.0;
    x = wrap == Wrap::Clamp ? std::clamp(x, 0.0, 1.0) : x - 2.0 * std::floor(0.5 * x);
    x = x * size - 0.5;
    const double below = std::floor(x);
    const auto i = static_cast<std::int64_t>(below);
    return {wrapped(i, size, wrap), wrapped(i + 1, size, wrap), static_cast<float>(x - below)};
}

} // namespace

Texture decode_texture(std::span<const std::byte> file, VOrigin origin) {
    constexpr int MaxEdge = 16384;
    if (file.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
        throw std::runtime_error(fmt::format("expected an image below 2 GiB, got {} bytes", file.size()));
    const auto* bytes = reinterpret_cast<const stbi_uc*>(file.data());
    const int num_bytes = static_cast<int>(file.size());
    int width = 0, height = 0, channels = 0;
    if (file.empty() || stbi_info_from_memory(bytes, num_bytes, &width, &height, &channels) == 0)
        throw std::runtime_error(fmt::format(
            "expected a PNG, JPEG, BMP or TGA image, got {} bytes of something else", file.size()));
    if (width < 1 || height < 1 || width > MaxEdge || height > MaxEdge)
        throw std::runtime_error(fmt::format("expected an image of at most {0} x {0} pixels, got {1} x {2}",
                                             MaxEdge, width, height));
    // Deflate packs at most 1032 to 1, of pixels of one bit: what declares more is broken, and would only cost memory.
    const std::uint64_t num_pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    if (num_pixels / 16384 > file.size())
        throw std::runtime_error(
            fmt::format("expected the data of {} x {} pixels, got {} bytes", width, height, file.size()));
    const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
        stbi_load_from_memory(bytes, num_bytes, &width, &height, &channels, 3), stbi_image_free);
    if (!pixels)
        throw std::runtime_error(fmt::format("expected a whole image of {} x {} pixels, got broken data ({})",
                                             width, height, stbi_failure_reason()));
    Texture texture;
    texture.width = static_cast<std::uint32_t>(width);
    texture.height = static_cast<std::uint32_t>(height);
    texture.texels.resize(num_pixels);
    for (std::size_t row = 0; row < texture.height; ++row) {
        const std::size_t from = origin == VOrigin::Top ? row : texture.height - 1 - row;
        std::memcpy(texture.texels.data() + row * texture.width, pixels.get() + from * texture.width * 3,
                    std::size_t{texture.width} * 3);
    }
    return texture;
}

glm::vec3 sample(const Texture& texture, const TextureSlot& slot, const glm::vec2& mesh_uv) {
    const glm::vec2 uv = slot.uv_from_mesh_uv * mesh_uv + slot.uv_offset;
    const Pair u = neighbours(uv.x, texture.width, slot.wrap[0]);
    const Pair v = neighbours(uv.y, texture.height, slot.wrap[1]);
    const auto texel = [&](std::uint32_t column, std::uint32_t row) {
        return decoded(texture.texels[std::size_t{row} * texture.width + column], slot.is_srgb);
    };
    return glm::mix(glm::mix(texel(u.first, v.first), texel(u.second, v.first), u.weight),
                    glm::mix(texel(u.first, v.second), texel(u.second, v.second), u.weight), v.weight);
}

} // namespace relumine::mesh
