// The pixels of an environment image as small areas of the sphere, for sums over the image itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "cubemap/image/image_layout.h"

namespace relumine::cubemap {

class Projection;

/// Cuts pixels into parts. An image has one panel of pixels, or six where it is made of faces.
class PixelParts {
public:
    /// Throws:  std::invalid_argument for proportions that do not fit the layout.
    explicit PixelParts(const ImageShape& shape);

    [[nodiscard]] std::uint32_t num_panels() const { return squares_ ? NumFaces : 1; }
    [[nodiscard]] std::uint32_t panel_width() const { return width_; }
    [[nodiscard]] std::uint32_t panel_height() const { return height_; }

    /// Returns the index of a panel's pixel in the image.
    [[nodiscard]] std::size_t pixel(std::uint32_t panel, std::uint32_t x, std::uint32_t y) const {
        return squares_ ? squares_->pixel(AllFaces[panel], x, y) : std::size_t{y} * width_ + x;
    }

    /// Appends n x n parts of a pixel, row by row: the direction of each part's middle and its
    /// solid angle. Parts outside of a disc are left out.
    void append(std::uint32_t panel, std::uint32_t x, std::uint32_t y, std::uint32_t n,
                std::vector<PixelPlace>& parts) const;

private:
    const Projection* projection_;
    std::optional<FaceSquares> squares_;
    std::uint32_t width_;
    std::uint32_t height_;
    /// Borders of the pixels in [0, 1].
    std::vector<double> columns_, rows_;
};

} // namespace relumine::cubemap
