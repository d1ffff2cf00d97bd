// Blocks of a face's texels, quartered until they are single texels.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "cubemap/layers/region.h"
#include "cubemap/layers/square_coverage.h"
#include "cubemap/texel_rectangle.h"

namespace relumine::cubemap {

/// The texels of a block [x0, x0 + size) x [y0, y0 + size) that lie in the face. The size is a
/// power of two.
struct TexelRange {
    TexelRange(std::uint32_t x, std::uint32_t y, std::uint32_t block_size, std::uint32_t resolution)
        : x0(x), y0(y), x1(std::min(x + block_size, resolution)),
          y1(std::min(y + block_size, resolution)), size(block_size), end(resolution) {}

    std::uint32_t x0, y0, x1, y1;
    std::uint32_t size, end;

    [[nodiscard]] bool empty() const { return x0 >= x1 || y0 >= y1; }
    [[nodiscard]] bool is_texel() const { return size == 1; }
    [[nodiscard]] TexelRange quarter(int i) const {
        const std::uint32_t half = size / 2;
        return {(i & 1) != 0 ? x0 + half : x0, (i & 2) != 0 ? y0 + half : y0, half, end};
    }
    /// Returns the part inside a rectangle. Do not quarter this part.
    [[nodiscard]] TexelRange within(const TexelRectangle& rectangle) const {
        TexelRange part = *this;
        part.x0 = std::max(x0, rectangle.x0);
        part.y0 = std::max(y0, rectangle.y0);
        part.x1 = std::min(x1, rectangle.x1);
        part.y1 = std::min(y1, rectangle.y1);
        return part;
    }
};

/// A face with its texels.
struct FaceGrid {
    FaceGrid(Face which, std::uint32_t resolution)
        : face(which), plane(which), half_texel(1.0 / resolution) {}
    Face face;
    FaceAxes plane;
    /// Half the width of a texel on the plane of [-1, 1]^2.
    double half_texel;

    [[nodiscard]] FaceSquare square(std::uint32_t x, std::uint32_t y) const {
        return {(2 * x + 1) * half_texel - 1.0, (2 * y + 1) * half_texel - 1.0, half_texel};
    }
};

/// The ball of directions that holds a block of texels.
struct BlockBall {
    BlockBall(const FaceGrid& grid, const TexelRange& range) {
        const double u = (range.x0 + range.x1) * grid.half_texel - 1.0;
        const double v = (range.y0 + range.y1) * grid.half_texel - 1.0;
        const double width = (range.x1 - range.x0) * grid.half_texel;
        const double height = (range.y1 - range.y0) * grid.half_texel;
        centre = grid.plane.direction(u, v);
        chord = std::sqrt(width * width + height * height);
    }
    glm::dvec3 centre;
    double chord;
};

/// Returns how a region meets the texels of a block. None and All are certain.
template<typename Shape>
[[nodiscard]] Overlap bound(const Shape& shape, const FaceGrid& grid, const TexelRange& range) {
    const BlockBall ball(grid, range);
    return shape.bound(ball.centre, ball.chord);
}

/// Returns the shape narrowed to a block by within().
template<typename Shape>
[[nodiscard]] decltype(auto) narrowed(const Shape& shape, const FaceGrid& grid,
                                      const TexelRange& range) {
    const BlockBall ball(grid, range);
    return shape.within(ball.centre, ball.chord);
}

} // namespace relumine::cubemap
