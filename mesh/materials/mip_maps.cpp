#include "mesh/materials/mip_maps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <mutex>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace relumine::mesh {

namespace {

/// A level: light in 16 bits, since 8 are too few for dark colours.
struct Level {
    std::uint32_t width = 0, height = 0;
    std::vector<std::array<std::uint16_t, 3>> texels;

    [[nodiscard]] glm::vec3 texel(std::uint32_t column, std::uint32_t row) const {
        const auto& own = texels[std::size_t{row} * width + column];
        return glm::vec3(own[0], own[1], own[2]) / 65535.0f;
    }
};

/// Source texels of a texel of the next level, and their weights: half as many texels cover the
/// same, also where the number is odd.
struct Span {
    std::uint32_t first = 0, count = 0;
    std::array<float, 3> weights{};
};

Span span_of(std::uint32_t i, std::uint32_t from, std::uint32_t to) {
    const double width = static_cast<double>(from) / to;
    const double begin = i * width, end = begin + width;
    Span span{.first = static_cast<std::uint32_t>(begin)};
    for (std::uint32_t k = span.first; k < std::min(from, span.first + 3) && k < end; ++k)
        span.weights[span.count++] = static_cast<float>(
            (std::min<double>(end, k + 1.0) - std::max<double>(begin, k)) / width);
    return span;
}

/// Returns a level of half the width and height of one whose texels `texel(column, row)` returns.
template<class Texel>
Level halved(std::uint32_t width, std::uint32_t height, const Texel& texel) {
    Level level{.width = std::max(width / 2, 1u), .height = std::max(height / 2, 1u), .texels = {}};
    level.texels.reserve(std::size_t{level.width} * level.height);
    for (std::uint32_t y = 0; y < level.height; ++y) {
        const Span rows = span_of(y, height, level.height);
        for (std::uint32_t x = 0; x < level.width; ++x) {
            const Span columns = span_of(x, width, level.width);
            glm::vec3 sum(0.0f);
            for (std::uint32_t j = 0; j < rows.count; ++j)
                for (std::uint32_t i = 0; i < columns.count; ++i)
                    sum += rows.weights[j] * columns.weights[i] *
                           texel(columns.first + i, rows.first + j);
            auto& own = level.texels.emplace_back();
            for (int channel = 0; channel < 3; ++channel)
                own[static_cast<std::size_t>(channel)] = static_cast<std::uint16_t>(
                    std::lround(std::clamp(sum[channel], 0.0f, 1.0f) * 65535.0f));
        }
    }
    return level;
}

} // namespace

/// The levels of a texture above its own texels.
class MipMaps::Pyramid {
public:
    [[nodiscard]] glm::vec3 sample(const Texture& texture, const TextureSlot& slot,
                                   const glm::vec2& uv, std::size_t level) {
        if (level == 0)
            return bilinear(uv, {texture.width, texture.height}, slot.wrap,
                            [&](std::uint32_t column, std::uint32_t row) {
                                return mesh::texel(texture, column, row, slot.is_srgb);
                            });
        std::call_once(is_made_, [&] { make(texture, slot.is_srgb); });
        if (levels_.empty())
            return sample(texture, slot, uv, 0);
        const Level& own = levels_[std::min(level, levels_.size()) - 1];
        return bilinear(
            uv, {own.width, own.height}, slot.wrap,
            [&](std::uint32_t column, std::uint32_t row) { return own.texel(column, row); });
    }

private:
    void make(const Texture& texture, bool is_srgb) {
        std::uint32_t width = texture.width, height = texture.height;
        while (width > 1 || height > 1) {
            if (levels_.empty())
                levels_.push_back(halved(width, height, [&](std::uint32_t x, std::uint32_t y) {
                    return mesh::texel(texture, x, y, is_srgb);
                }));
            else
                levels_.push_back(halved(width, height, [&](std::uint32_t x, std::uint32_t y) {
                    return levels_.back().texel(x, y);
                }));
            width = levels_.back().width;
            height = levels_.back().height;
        }
    }

    std::once_flag is_made_;
    std::vector<Level> levels_;
};

MipMaps::MipMaps(const std::vector<Texture>& textures)
    : textures_(&textures), pyramids_(std::make_unique<Pyramid[]>(2 * textures.size())) {}
MipMaps::~MipMaps() = default;

glm::vec3 MipMaps::sample(const TextureSlot& slot, const glm::vec2& mesh_uv,
                          const Footprint& footprint) const {
    /// Looks along the longer axis.
    constexpr float MostLooks = 16.0f;
    const Texture& texture = (*textures_)[slot.texture];
    const glm::vec2 size(texture.width, texture.height);
    glm::vec2 longer = slot.uv_from_mesh_uv * footprint.right * size;
    glm::vec2 other = slot.uv_from_mesh_uv * footprint.down * size;
    if (glm::length(other) > glm::length(longer))
        std::swap(longer, other);
    const float length = glm::length(longer); // in texels
    if (!(length > 1.0f) || !std::isfinite(length))
        return mesh::sample(texture, slot, mesh_uv);
    const float width = std::abs(longer.x * other.y - longer.y * other.x) / length;
    const auto num_looks =
        static_cast<int>(std::ceil(std::min(length / std::max(width, 1.0f), MostLooks)));
    const auto looks = static_cast<float>(num_looks);
    const float detail = std::log2(std::max(length / looks, 1.0f));
    const auto level = static_cast<std::size_t>(detail);
    const float rest = detail - static_cast<float>(level);
    const glm::vec2 uv = slot.uv_from_mesh_uv * mesh_uv + slot.uv_offset;
    Pyramid& pyramid = pyramids_[2 * std::size_t{slot.texture} + (slot.is_srgb ? 1 : 0)];
    glm::vec3 sum(0.0f);
    for (int i = 0; i < num_looks; ++i) {
        const float place = (static_cast<float>(i) + 0.5f) / looks - 0.5f;
        const glm::vec2 at = uv + place * longer / size;
        sum += glm::mix(pyramid.sample(texture, slot, at, level),
                        pyramid.sample(texture, slot, at, level + 1), rest);
    }
    return sum / looks;
}

} // namespace relumine::mesh
