// A rectangle of a lat-long image's pixels.
#pragma once

#include <cstdint>

namespace relumine::lights {

/// Pixels [x0, x1) x [y0, y1) of a lat-long.
struct PixelRectangle {
    std::uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    [[nodiscard]] std::uint32_t width() const { return x1 - x0; }
    [[nodiscard]] std::uint32_t height() const { return y1 - y0; }
    bool operator==(const PixelRectangle&) const = default;
};

} // namespace relumine::lights
