// Symmetries that an image's pixels and a cube map's texels share: what is found out about one
// pixel holds for its images, too.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <glm/mat3x3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/image/image_layout.h"

namespace relumine::cubemap::detail {

/// A mirror or quarter turn of the sphere that carries pixels to pixels and texels to texels.
class PixelSymmetry {
public:
    /// How the pixels move, in this order: columns and rows are exchanged, mirrored, shifted.
    struct Move {
        bool swaps = false, mirrors_x = false, mirrors_y = false;
        std::uint32_t shift = 0;
    };
    PixelSymmetry(const ImageShape& shape, const Move& move, const glm::dmat3& turn,
                  std::uint32_t resolution);

    /// Returns the index of the pixel to which pixel (x, y) moves.
    [[nodiscard]] std::size_t pixel(std::uint32_t x, std::uint32_t y) const {
        if (move_.swaps)
            std::swap(x, y);
        x = move_.mirrors_x ? width_ - 1 - x : x;
        y = move_.mirrors_y ? height_ - 1 - y : y;
        x += move_.shift;
        x = x >= width_ ? x - width_ : x;
        return static_cast<std::size_t>(y) * width_ + x;
    }
    /// Returns the index of the texel to which a texel moves.
    [[nodiscard]] std::size_t texel(Face face, std::uint32_t x, std::uint32_t y) const {
        const FaceMove& to = faces_[static_cast<std::size_t>(face)];
        return static_cast<std::size_t>(to.start + to.per_x * x + to.per_y * y);
    }

private:
    /// Texel (x, y) moves to the index start + per_x x + per_y y.
    struct FaceMove {
        std::int64_t start, per_x, per_y;
    };
    Move move_;
    std::uint32_t width_, height_;
    std::array<FaceMove, NumFaces> faces_{};
};

/// Returns the symmetries of an image's pixels whose directions `turn` carries to the cube map's,
/// the identity first. Only the identity for a turn that does not carry axes to axes, and for
/// layouts with faces.
[[nodiscard]] std::vector<PixelSymmetry>
pixel_symmetries(const ImageShape& shape, const glm::dmat3& turn, std::uint32_t resolution);

/// Calls `visit(symmetry_index, pixel_index)` for the images of pixel (x, y), whose index is
/// `pixel`, itself first. An image that several symmetries make, because the pixel lies on a
/// mirror, comes once.
template<typename Visit>
void for_each_image(std::span<const PixelSymmetry> symmetries, std::size_t pixel, std::uint32_t x,
                    std::uint32_t y, const Visit& visit) {
    std::array<std::size_t, 32> images{};
    for (std::size_t i = 0; i < symmetries.size(); ++i) {
        images[i] = i == 0 ? pixel : symmetries[i].pixel(x, y);
        auto* const end = images.begin() + i;
        if (std::find(images.begin(), end, images[i]) == end)
            visit(i, images[i]);
    }
}

/// Whether none of the images of pixel (x, y) under the symmetries comes before this pixel.
[[nodiscard]] inline bool is_first_of_images(std::span<const PixelSymmetry> symmetries,
                                             std::uint32_t x, std::uint32_t y) {
    const std::size_t own = symmetries.front().pixel(x, y);
    return std::all_of(symmetries.begin() + 1, symmetries.end(),
                       [&](const auto& each) { return each.pixel(x, y) >= own; });
}

} // namespace relumine::cubemap::detail
