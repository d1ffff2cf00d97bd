// What a picture's pixels see of a backdrop.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/receivers/camera.h"
#include "relight/pictures/backdrop.h"
#include "relight/pictures/raster.h"

namespace relumine::relight {

/// What the pixels of a rectangle see of a backdrop. Where the backdrop has a chart, the image's
/// places at the corners of pixels are computed once each, and samples lie in between. For one
/// thread.
class BackdropPixels {
public:
    /// All must outlive this object.
    BackdropPixels(const prt::PictureRays& rays, const Backdrop& backdrop,
                   const PixelRectangle& pixels);

    /// Returns the mean over a pixel's samples, of which each lets through what `passed` says,
    /// [samples per pixel].
    [[nodiscard]] glm::vec3 seen(std::uint32_t x, std::uint32_t y,
                                 std::span<const glm::vec3> passed);

private:
    [[nodiscard]] const ChartSpot& corner(std::uint32_t x, std::uint32_t y);
    /// Whether the places of a pixel's samples follow from those of its corners.
    [[nodiscard]] bool is_smooth(std::uint32_t x, std::uint32_t y);
    [[nodiscard]] glm::vec3 seen_on(const Chart& chart, const std::array<ChartSpot, 4>& corners,
                                    std::span<const glm::vec3> passed) const;

    const prt::PictureRays& rays_;
    const Backdrop& backdrop_;
    PixelRectangle pixels_;
    /// [(height + 1) x (width + 1)] of the corners of pixels, where they are known.
    std::vector<ChartSpot> spots_;
    std::vector<bool> known_;
};

} // namespace relumine::relight
