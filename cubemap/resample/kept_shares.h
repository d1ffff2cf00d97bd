// The overlaps of an image's pixels with the texels of a cube map, found once for averages in both
// directions.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/image/image_layout.h"
#include "cubemap/resample/pixel_symmetry.h"

namespace relumine::cubemap::detail {

class RowsOfShares;

/// Keeps the overlaps of the pixels that are the first of their images under the symmetries: one in
/// eight for most layouts.
///
/// Memory:  12 bytes per overlap that is kept, some 60 MB for an octahedral map of 2896 x 2896 and
///          a cube map as fine.
class KeptShares {
public:
    /// For layouts without faces.
    KeptShares(const ImageShape& shape, std::uint32_t resolution);

    /// Returns the mean of the pixels over each texel, as cube_from_projection() does bit by bit;
    /// black where there are none.
    [[nodiscard]] CubeMap to_cube(const std::vector<glm::vec3>& pixels) const;

    /// Returns the mean of the texels under each pixel, as fill_from_shares() does bit by bit;
    /// black where there are none.
    [[nodiscard]] std::vector<glm::vec3> to_pixels(const CubeMap& map) const;

private:
    struct Pixel {
        std::uint32_t x;
        /// Where its shares end in the row. They begin where the shares of the pixel before end.
        std::uint32_t end;
        /// The symmetries that carry it to different pixels, as bits.
        std::uint32_t images;
        /// The faces that it overlaps, as bits.
        std::uint32_t faces;
    };
    struct Texel {
        std::uint32_t face : 4, x : 14, y : 14;
    };
    struct Row {
        std::vector<Pixel> pixels;
        std::vector<Texel> texels;
        /// [texels] solid angle of the pixel's overlap with each.
        std::vector<double> solid_angles;
    };

    struct Sum {
        glm::dvec3 radiance{0.0};
        double weight = 0.0;
    };

    [[nodiscard]] Row found_row(std::uint32_t y, RowsOfShares& finder) const;
    /// `sums` is memory to use.
    void fill_face(const std::vector<glm::vec3>& pixels, std::size_t face, std::vector<Sum>& sums,
                   CubeMap& map) const;

    ImageShape shape_;
    std::uint32_t resolution_;
    std::vector<PixelSymmetry> symmetries_;
    /// The face to which each symmetry carries each face.
    std::vector<std::array<std::uint32_t, NumFaces>> moved_faces_;
    std::vector<Row> rows_;
};

} // namespace relumine::cubemap::detail
