// The overlaps of an image's pixels with the texels of a cube map, for every layout.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "cubemap/cube_map.h"
#include "cubemap/image/image_layout.h"
#include "cubemap/resample/footprint.h"
#include "cubemap/resample/lat_long_footprint.h"
#include "cubemap/resample/projection.h"
#include "cubemap/spherical_overlap.h"

namespace relumine::cubemap::detail {

/// The overlap of one pixel with one texel, in steradians.
struct PixelShare {
    std::uint32_t pixel;
    std::uint32_t texel;
    double solid_angle;
};

/// Visits the footprints of an image's pixels row by row.
///
/// Threads: use one object per thread; it keeps its buffers.
class PixelFootprints {
public:
    explicit PixelFootprints(const ImageShape& shape)
        : width_(shape.width), num_rows_(shape.height) {
        if (shape.layout == Layout::LatLong) {
            lat_long_.emplace(shape);
        } else if (const Projection* picture = projection(shape.layout)) {
            pieces_.emplace(*picture, shape.width, shape.height);
        } else {
            squares_.emplace(shape.layout, shape.width, shape.height);
            num_rows_ = squares_->resolution();
            borders_ = cell_borders(num_rows_, shape.sampling);
        }
    }

    /// Returns the number of rows of the picture. For layouts with faces: the number of rows of a
    /// face; a row then runs over all six faces.
    [[nodiscard]] std::uint32_t num_rows() const { return num_rows_; }

    /// Calls `visit(pixel_index, std::span<const glm::dvec3>)` with the corners of each piece,
    /// clockwise seen from the middle of the sphere.
    template<typename Visit>
    void visit_row(std::uint32_t y, const Visit& visit) {
        if (squares_) {
            for (const Face face : AllFaces) {
                for (std::uint32_t x = 0; x < num_rows_; ++x) {
                    const std::array<glm::dvec3, 4> corners = {
                        cube_point(face, borders_[x], borders_[y]),
                        cube_point(face, borders_[x + 1], borders_[y]),
                        cube_point(face, borders_[x + 1], borders_[y + 1]),
                        cube_point(face, borders_[x], borders_[y + 1])};
                    visit(squares_->pixel(face, x, y), std::span<const glm::dvec3>(corners));
                }
            }
            return;
        }
        for (std::uint32_t x = 0; x < width_; ++x) {
            const auto take = [&](std::span<const glm::dvec3> corners) {
                visit(static_cast<std::size_t>(y) * width_ + x, corners);
            };
            if (lat_long_)
                lat_long_->visit(x, y, take);
            else
                pieces_->visit(x, y, take);
        }
    }

private:
    std::uint32_t width_, num_rows_;
    std::optional<LatLongFootprints> lat_long_;
    std::optional<ProjectionFootprints> pieces_;
    std::optional<FaceSquares> squares_;
    std::vector<double> borders_;
};

/// Calls `take(std::span<const PixelShare>)` for each row of pixels, in order. Rows are computed in
/// parallel, one band at a time. All shares of a pixel follow each other; a texel may come more
/// than once. `turn` carries directions of the image to directions of the cube map.
template<typename Take>
void for_each_row_of_shares(const ImageShape& shape, const glm::dmat3& turn,
                            std::uint32_t resolution, const Take& take) {
    constexpr std::uint32_t BandHeight = 32;
    const bool is_turned = turn != glm::dmat3(1.0), is_mirrored = glm::determinant(turn) < 0.0;
    const CubeMap map(resolution);
    const std::uint32_t num_rows = PixelFootprints(shape).num_rows();
    std::vector<std::vector<PixelShare>> shares(BandHeight);
    for (std::uint32_t band = 0; band < num_rows; band += BandHeight) {
        const std::uint32_t end = std::min(band + BandHeight, num_rows);
        tbb::parallel_for(tbb::blocked_range<std::uint32_t>(band, end), [&](const auto& rows) {
            PixelFootprints footprints(shape);
            TexelOverlaps overlaps(resolution);
            std::vector<glm::dvec3> turned;
            for (std::uint32_t y = rows.begin(); y != rows.end(); ++y) {
                std::vector<PixelShare>& found = shares[y - band];
                found.clear();
                footprints.visit_row(
                    y, [&](std::size_t pixel, std::span<const glm::dvec3> corners) {
                        if (is_turned) {
                            turned.clear();
                            for (const glm::dvec3& corner : corners)
                                turned.push_back(turn * corner);
                            if (is_mirrored)
                                std::reverse(turned.begin(), turned.end());
                            corners = turned;
                        }
                        overlaps.find(corners, [&](Face face, std::uint32_t column,
                                                   std::uint32_t row, double solid_angle) {
                            found.push_back(
                                {static_cast<std::uint32_t>(pixel), // MaxPixels is below 2^32
                                 static_cast<std::uint32_t>(map.index(face, column, row)),
                                 solid_angle});
                        });
                    });
            }
        });
        for (std::uint32_t y = band; y < end; ++y)
            take(std::span<const PixelShare>(shares[y - band]));
    }
}

} // namespace relumine::cubemap::detail
