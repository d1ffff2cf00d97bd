// Which pixels of one image lie on which of another one, and how much: found once, to average there
// and back as often as one likes.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/mat3x3.hpp>

#include "cubemap/image/environment.h"
#include "cubemap/image/image_layout.h"

namespace relumine::cubemap {

/// Overlaps of two images' pixels, by way of a cube map of a resolution in the source's directions
/// or in the target's: within a texel everything is taken as mixed. Some 12 bytes per pair of
/// pixels; more while it is made.
class PixelLinks {
public:
    enum class Axes { Source, Target };
    PixelLinks(const ImageShape& source, const ImageShape& target,
               const glm::dmat3& target_from_source, std::uint32_t resolution, Axes axes);

    /// Each pixel of the target the mean over its footprint; `pixels` are the source's. Pixels that
    /// show nothing are black.
    [[nodiscard]] std::vector<glm::vec3> to_target(const std::vector<glm::vec3>& pixels) const;
    /// Each pixel of the source the mean over its footprint; `pixels` are the target's.
    [[nodiscard]] std::vector<glm::vec3> to_source(const std::vector<glm::vec3>& pixels) const;

private:
    std::size_t num_source_pixels_;
    // The links of target pixel i are [starts_[i], starts_[i + 1]).
    std::vector<std::size_t> starts_;
    std::vector<std::uint32_t> sources_;
    std::vector<double> solid_angles_;
    /// Sums per source pixel
    std::vector<double> source_angles_;
};

} // namespace relumine::cubemap
