// A part of a cube map's face, counted in texels.
#pragma once

#include <cstdint>

#include "cubemap/face.h"

namespace relumine::cubemap {

/// Texels [x0, x1) x [y0, y1) of a face.
struct TexelRectangle {
    Face face = Face::PositiveX;
    std::uint32_t x0 = 0;
    std::uint32_t y0 = 0;
    std::uint32_t x1 = 0;
    std::uint32_t y1 = 0;
    bool operator==(const TexelRectangle&) const = default;
};

} // namespace relumine::cubemap
