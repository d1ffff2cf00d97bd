// Overlaps of the pixels of two images. They are found once and then average pixels in both
// directions, as often as needed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "cubemap/image/environment.h"
#include "cubemap/image/image_layout.h"

namespace relumine::cubemap {

/// For each pixel of one image, the pixels of another that it shows and their parts of it. The
/// parts of a pixel add up to 1, or there are none.
struct PixelMeans {
    struct Part {
        std::uint32_t pixel;
        float part;
    };
    // The parts of pixel i are [starts[i], starts[i + 1]).
    std::vector<std::size_t> starts;
    std::vector<Part> parts;

    /// Averages the other image's `pixels` over each pixel; black where there are no parts.
    [[nodiscard]] std::vector<glm::vec3> of(const std::vector<glm::vec3>& pixels) const;
};

/// The overlaps of two images' pixels, found by way of a cube map. The cube map has the given
/// resolution and lies along the axes of the source or of the target. Pixels that meet in one texel
/// are taken as mixed all over the texel.
///
/// Memory:  16 bytes per pair of pixels, and more during construction.
class PixelLinks {
public:
    enum class Axes { Source, Target };
    PixelLinks(const ImageShape& source, const ImageShape& target,
               const glm::dmat3& target_from_source, std::uint32_t resolution, Axes axes);

    /// Averages the source's `pixels` over the footprint of each target pixel. Target pixels that
    /// show nothing are black.
    [[nodiscard]] std::vector<glm::vec3> to_target(const std::vector<glm::vec3>& pixels) const {
        return targets_.of(pixels);
    }
    /// Averages the target's `pixels` over the footprint of each source pixel.
    [[nodiscard]] std::vector<glm::vec3> to_source(const std::vector<glm::vec3>& pixels) const {
        return sources_.of(pixels);
    }

private:
    PixelMeans targets_, sources_;
};

} // namespace relumine::cubemap
