// The rays through the pixels of a camera's picture.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/camera.h"

namespace relumine::prt {

using mesh::Camera;

/// Axes of a camera. Right and up are scaled to reach the picture's edges at distance 1.
struct CameraAxes {
    glm::vec3 right, up, forward;
};

/// Returns the axes of a camera: mesh::rolled_axes(). `aspect` is width over height.
///
/// Throws:  std::invalid_argument for a camera whose target is its eye, a field of view outside
///          (0, 180), or a roll that is not finite.
[[nodiscard]] CameraAxes axes_of(const Camera& camera, float aspect);

/// The most pixels a picture has on a side, and the most samples a pixel has on a side.
inline constexpr std::uint32_t MaxPictureSize = 16384;
inline constexpr std::uint32_t MaxSamplesPerAxis = 64;

/// The rays of a picture: n x n per pixel on a regular grid. For n = 1 the ray goes through the
/// pixel's centre.
class PictureRays {
public:
    /// Throws:  std::invalid_argument as axes_of() does, and for a size or a number of samples
    ///          beyond the limits above.
    PictureRays(const Camera& camera, std::uint32_t width, std::uint32_t height,
                std::uint32_t samples_per_axis);

    [[nodiscard]] std::uint32_t samples_per_axis() const { return samples_per_axis_; }
    [[nodiscard]] std::uint32_t samples_per_pixel() const {
        return samples_per_axis_ * samples_per_axis_;
    }
    /// Returns the unit direction of sample i of pixel (x, y). Pixels count from the top left;
    /// samples count row by row.
    [[nodiscard]] glm::vec3 direction(std::uint32_t x, std::uint32_t y, std::uint32_t i) const;
    /// Returns the unit direction of a place in the picture, in pixels from its top left corner.
    [[nodiscard]] glm::vec3 direction(const glm::vec2& place) const;
    /// Returns the steps between samples, at distance 1.
    [[nodiscard]] glm::vec3 right() const { return right_ / static_cast<float>(samples_per_axis_); }
    [[nodiscard]] glm::vec3 down() const { return down_ / static_cast<float>(samples_per_axis_); }
    [[nodiscard]] const glm::vec3& forward() const { return forward_; }
    /// Returns where the picture's top left corner lies, at distance 1.
    [[nodiscard]] const glm::vec3& corner() const { return corner_; }

private:
    std::uint32_t samples_per_axis_;
    /// Towards the picture's top left corner, one pixel to the right and down, and the axis.
    glm::vec3 corner_, right_, down_, forward_;
    /// [samples per pixel] places in the pixel, from its top left corner.
    std::vector<glm::vec2> places_;
};

} // namespace relumine::prt
