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

/// Returns the normal that a texel of a normal map stands for; straight up where it is none.
glm::vec3 unit_normal(const glm::vec3& texel) {
    const glm::vec3 normal = tangent_vector(texel);
    const float length = glm::length(normal);
    return length > 0.0f ? normal / length : glm::vec3(0.0f, 0.0f, 1.0f);
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
    [[nodiscard]] glm::vec3 sample(const Texture& texture, Kind kind,
                                   const std::array<Wrap, 2>& wrap, const glm::vec2& uv,
                                   std::size_t level) {
        if (level == 0)
            return bilinear(uv, {texture.width, texture.height}, wrap,
                            [&](std::uint32_t column, std::uint32_t row) {
                                return texel(texture, kind, column, row);
                            });
        std::call_once(is_made_, [&] { make(texture, kind); });
        if (levels_.empty())
            return sample(texture, kind, wrap, uv, 0);
        const Level& own = levels_[std::min(level, levels_.size()) - 1];
        return bilinear(
            uv, {own.width, own.height}, wrap,
            [&](std::uint32_t column, std::uint32_t row) { return own.texel(column, row); });
    }

private:
    /// Normals are of unit length, their components in [0, 1].
    static glm::vec3 texel(const Texture& texture, Kind kind, std::uint32_t column,
                           std::uint32_t row) {
        const glm::vec3 own = mesh::texel(texture, column, row, kind == Kind::Srgb);
        return kind == Kind::Normals ? 0.5f * unit_normal(own) + 0.5f : own;
    }

    void make(const Texture& texture, Kind kind) {
        std::uint32_t width = texture.width, height = texture.height;
        while (width > 1 || height > 1) {
            if (levels_.empty())
                levels_.push_back(halved(width, height, [&](std::uint32_t x, std::uint32_t y) {
                    return texel(texture, kind, x, y);
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
    : textures_(&textures), pyramids_(std::make_unique<Pyramid[]>(NumKinds * textures.size())) {}
MipMaps::~MipMaps() = default;

glm::vec3 MipMaps::sample(const TextureSlot& slot, const glm::vec2& mesh_uv,
                          const Footprint& footprint) const {
    const auto found = mean(slot, mesh_uv, footprint, slot.is_srgb ? Kind::Srgb : Kind::Linear);
    return found ? *found : mesh::sample((*textures_)[slot.texture], slot, mesh_uv);
}

glm::vec3 MipMaps::normal(const TextureSlot& slot, const glm::vec2& mesh_uv,
                          const Footprint& footprint) const {
    const auto found = mean(slot, mesh_uv, footprint, Kind::Normals);
    if (!found)
        return unit_normal(mesh::sample((*textures_)[slot.texture], slot, mesh_uv));
    // What a level's 16 bits make of 0
    constexpr float Least = 1e-4f;
    glm::vec3 normal = 2.0f * *found - 1.0f;
    for (int axis = 0; axis < 2; ++axis)
        if (std::abs(normal[axis]) < Least)
            normal[axis] = 0.0f;
    return normal;
}

std::optional<glm::vec3> MipMaps::mean(const TextureSlot& slot, const glm::vec2& mesh_uv,
                                       const Footprint& footprint, Kind kind) const {
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
        return std::nullopt;
    const float width = std::abs(longer.x * other.y - longer.y * other.x) / length;
    const auto num_looks =
        static_cast<int>(std::ceil(std::min(length / std::max(width, 1.0f), MostLooks)));
    const auto looks = static_cast<float>(num_looks);
    const float detail = std::log2(std::max(length / looks, 1.0f));
    const auto level = static_cast<std::size_t>(detail);
    const float rest = detail - static_cast<float>(level);
    const glm::vec2 uv = slot.uv_from_mesh_uv * mesh_uv + slot.uv_offset;
    Pyramid& pyramid =
        pyramids_[NumKinds * std::size_t{slot.texture} + static_cast<std::size_t>(kind)];
    glm::vec3 sum(0.0f);
    for (int i = 0; i < num_looks; ++i) {
        const float place = (static_cast<float>(i) + 0.5f) / looks - 0.5f;
        const glm::vec2 at = uv + place * longer / size;
        sum += glm::mix(pyramid.sample(texture, kind, slot.wrap, at, level),
                        pyramid.sample(texture, kind, slot.wrap, at, level + 1), rest);
    }
    return sum / looks;
}

} // namespace relumine::mesh
