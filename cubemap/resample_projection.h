// Pictures of a Projection to cube maps and back, from exact overlaps. Called through resample() and to_image().
#pragma once

#include <cstdint>
#include <vector>

#include "cubemap/cube_map.h"
#include "cubemap/environment.h"
#include "cubemap/image_layout.h"

namespace relumine::cubemap::detail {

[[nodiscard]] CubeMap cube_from_projection(const EnvironmentImage& image, std::uint32_t resolution);

/// The overlaps of all pixels of a shape with the texels of a cube map, kept for use again and again: 16 bytes each, some five per pixel.
class ProjectionOverlaps {
public:
    ProjectionOverlaps(const ImageShape& shape, std::uint32_t resolution);
    /// As cube_from_projection() and fill_projection() do.
    [[nodiscard]] CubeMap to_cube(const EnvironmentImage& image) const;
    void fill(const CubeMap& map, EnvironmentImage& image) const;

private:
    /// What a pixel gives to a texel.
    struct Share {
        std::uint32_t pixel;
        std::uint32_t texel;
        double solid_angle;
    };
    std::uint32_t resolution_;
    std::vector<Share> shares_; ///< in the order of pixels
};

/// Fills the pixels of an image whose layout and size are set; pixels that show nothing are black.
void fill_projection(const CubeMap& map, EnvironmentImage& image);

} // namespace relumine::cubemap::detail
