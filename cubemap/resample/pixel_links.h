// Overlaps of the pixels of two images. They are found once and then average pixels in both
// directions, as often as needed.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/mat3x3.hpp>

#include "cubemap/image/environment.h"
#include "cubemap/image/image_layout.h"

namespace relumine::cubemap {

/// The overlaps of two images' pixels, found by way of a cube map. The cube map has the given
/// resolution and lies along the axes of the source or of the target. Pixels that meet in one texel
/// are taken as mixed all over the texel.
///
/// Memory:  about 20 bytes per pair of pixels, and more during construction.
class PixelLinks {
public:
    enum class Axes { Source, Target };
    PixelLinks(const ImageShape& source, const ImageShape& target,
               const glm::dmat3& target_from_source, std::uint32_t resolution, Axes axes);

    /// Averages the source's `pixels` over the footprint of each target pixel. Target pixels that
    /// show nothing are black.
    [[nodiscard]] std::vector<glm::vec3> to_target(const std::vector<glm::vec3>& pixels) const;
    /// Averages the target's `pixels` over the footprint of each source pixel.
    [[nodiscard]] std::vector<glm::vec3> to_source(const std::vector<glm::vec3>& pixels) const;

private:
    void sort_by_source();

    std::size_t num_source_pixels_;
    // The links of target pixel i are [starts_[i], starts_[i + 1]).
    std::vector<std::size_t> starts_;
    std::vector<std::uint32_t> sources_;
    std::vector<double> solid_angles_;
    /// Sum of the links' solid angles, per source pixel.
    std::vector<double> source_angles_;
    /// A link seen from its source pixel. There are below 2^32 links: pictures with links are
    /// small.
    struct Back {
        std::uint32_t target, link;
    };
    // The links of source pixel i are [source_starts_[i], source_starts_[i + 1]), targets
    // ascending.
    std::vector<std::size_t> source_starts_;
    std::vector<Back> back_;
};

} // namespace relumine::cubemap
