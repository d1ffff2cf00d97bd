// A rectangle of texels on a face of a cube map.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "cubemap/face.h"

namespace relumine::cubemap {

/// The texels [x0, x1) x [y0, y1) of a face.
struct TexelRectangle {
    Face face = Face::PositiveX;
    std::uint32_t x0 = 0;
    std::uint32_t y0 = 0;
    std::uint32_t x1 = 0;
    std::uint32_t y1 = 0;
    bool operator==(const TexelRectangle&) const = default;

    [[nodiscard]] std::uint64_t num_texels() const { return std::uint64_t{x1 - x0} * (y1 - y0); }
};

/// Adds a rectangle to a list. A rectangle of the list grows instead if the rectangle around both
/// covers no more texels than the two apart.
inline void add_merged(const TexelRectangle& rectangle, std::vector<TexelRectangle>& list) {
    for (TexelRectangle& other : list) {
        if (other.face != rectangle.face)
            continue;
        const TexelRectangle both = {.face = rectangle.face,
                                     .x0 = std::min(rectangle.x0, other.x0),
                                     .y0 = std::min(rectangle.y0, other.y0),
                                     .x1 = std::max(rectangle.x1, other.x1),
                                     .y1 = std::max(rectangle.y1, other.y1)};
        if (both.num_texels() <= rectangle.num_texels() + other.num_texels()) {
            other = both;
            return;
        }
    }
    list.push_back(rectangle);
}

} // namespace relumine::cubemap
