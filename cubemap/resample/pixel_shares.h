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

#include "cubemap/cube_map.h"
#include "cubemap/image/footprint.h"
#include "cubemap/image/image_layout.h"
#include "cubemap/image/projection.h"
#include "cubemap/resample/pixel_symmetry.h"
#include "cubemap/spherical_overlap.h"
#include "files/parallel.h"

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

    /// Calls `visit(pixel_index, x, std::span<const glm::dvec3>)` with the corners of each piece of
    /// the pixels that `wants(x)`, clockwise seen from the middle of the sphere.
    template<typename Wants, typename Visit>
    void visit_row(std::uint32_t y, const Wants& wants, const Visit& visit) {
        if (squares_) {
            for (const Face face : AllFaces) {
                for (std::uint32_t x = 0; x < num_rows_; ++x) {
                    const std::array<glm::dvec3, 4> corners = {
                        cube_point(face, borders_[x], borders_[y]),
                        cube_point(face, borders_[x + 1], borders_[y]),
                        cube_point(face, borders_[x + 1], borders_[y + 1]),
                        cube_point(face, borders_[x], borders_[y + 1])};
                    visit(squares_->pixel(face, x, y), x, std::span<const glm::dvec3>(corners));
                }
            }
            return;
        }
        for (std::uint32_t x = 0; x < width_; ++x) {
            if (!wants(x))
                continue;
            const std::size_t pixel = static_cast<std::size_t>(y) * width_ + x;
            const auto take = [&](std::span<const glm::dvec3> corners) {
                visit(pixel, x, corners);
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

/// Finds the shares of an image's pixels row by row. The shares of a pixel that is not the first of
/// its images under the symmetries come with the row of the first one.
///
/// Threads: use one object per thread; it keeps its buffers.
class RowsOfShares {
public:
    /// `turn` carries directions of the image to directions of the cube map. `symmetries` are those
    /// of pixel_symmetries() and must outlive this object.
    RowsOfShares(const ImageShape& shape, const glm::dmat3& turn, std::uint32_t resolution,
                 std::span<const PixelSymmetry> symmetries)
        : footprints_(shape), overlaps_(resolution), symmetries_(symmetries), turn_(turn),
          is_turned_(turn != glm::dmat3(1.0)), is_mirrored_(glm::determinant(turn) < 0.0) {}

    /// Puts the shares of a row into `shares`. All shares of a pixel follow each other; a texel may
    /// come more than once.
    void find(std::uint32_t y, std::vector<PixelShare>& shares) {
        shares.clear();
        found_.clear();
        const auto is_first = [&](std::uint32_t x) {
            return is_first_of_images(symmetries_, x, y);
        };
        // A pixel has several pieces; its shares are complete when the next pixel begins.
        std::size_t current = 0;
        std::uint32_t column = 0;
        const auto flush = [&] {
            if (!found_.empty())
                add_images(current, column, y, shares);
            found_.clear();
        };
        footprints_.visit_row(
            y, is_first,
            [&](std::size_t pixel, std::uint32_t x, std::span<const glm::dvec3> corners) {
                if (pixel != current)
                    flush();
                current = pixel;
                column = x;
                if (is_turned_) {
                    turned_.clear();
                    for (const glm::dvec3& corner : corners)
                        turned_.push_back(turn_ * corner);
                    if (is_mirrored_)
                        std::reverse(turned_.begin(), turned_.end());
                    corners = turned_;
                }
                overlaps_.find(corners, [&](Face face, std::uint32_t texel_x, std::uint32_t texel_y,
                                            double solid_angle) {
                    found_.push_back({face, texel_x, texel_y, solid_angle});
                });
            });
        flush();
    }

private:
    /// The overlap of a pixel with a texel.
    struct Found {
        Face face;
        std::uint32_t x, y;
        double solid_angle;
    };

    /// Writes the shares of a pixel, whose overlaps are found_, and of its images.
    void add_images(std::size_t pixel, std::uint32_t x, std::uint32_t y,
                    std::vector<PixelShare>& shares) {
        for_each_image(symmetries_, pixel, x, y, [&](std::size_t i, std::size_t image) {
            for (const Found& each : found_)
                shares.push_back(
                    {static_cast<std::uint32_t>(image), // MaxPixels is below 2^32
                     static_cast<std::uint32_t>(symmetries_[i].texel(each.face, each.x, each.y)),
                     each.solid_angle});
        });
    }

    PixelFootprints footprints_;
    TexelOverlaps overlaps_;
    std::span<const PixelSymmetry> symmetries_;
    glm::dmat3 turn_;
    bool is_turned_, is_mirrored_;
    std::vector<glm::dvec3> turned_;
    std::vector<Found> found_;
};

/// Calls `take(std::span<const PixelShare>)` for rows of shares, in order. Rows are computed in
/// parallel, one band at a time.
template<typename Take>
void for_each_row_of_shares(const ImageShape& shape, const glm::dmat3& turn,
                            std::uint32_t resolution, const Take& take) {
    constexpr std::uint32_t BandHeight = 32;
    const std::vector<PixelSymmetry> symmetries = pixel_symmetries(shape, turn, resolution);
    const std::uint32_t num_rows = PixelFootprints(shape).num_rows();
    std::vector<std::vector<PixelShare>> shares(BandHeight);
    for (std::uint32_t band = 0; band < num_rows; band += BandHeight) {
        const std::uint32_t end = std::min(band + BandHeight, num_rows);
        files::parallel_for(files::IndexRange<std::uint32_t>(band, end), [&](const auto& rows) {
            RowsOfShares finder(shape, turn, resolution, symmetries);
            for (std::uint32_t y = rows.begin(); y != rows.end(); ++y)
                finder.find(y, shares[y - band]);
        });
        for (std::uint32_t y = band; y < end; ++y)
            take(std::span<const PixelShare>(shares[y - band]));
    }
}

/// Fills an image whose shape is set: every pixel is the mean of the texels under its footprint.
/// Pixels that show nothing are black.
inline void fill_from_shares(const CubeMap& map, EnvironmentImage& image) {
    const ImageShape shape = shape_of(image);
    const std::vector<PixelSymmetry> symmetries =
        pixel_symmetries(shape, glm::dmat3(1.0), map.resolution);
    std::fill(image.pixels.begin(), image.pixels.end(), glm::vec3(0.0f));
    files::parallel_for(files::IndexRange<std::uint32_t>(0, PixelFootprints(shape).num_rows()),
                        [&](const auto& rows) {
                            RowsOfShares finder(shape, glm::dmat3(1.0), map.resolution, symmetries);
                            std::vector<PixelShare> shares;
                            for (std::uint32_t y = rows.begin(); y != rows.end(); ++y) {
                                finder.find(y, shares);
                                for (std::size_t i = 0; i < shares.size();) {
                                    const std::uint32_t pixel = shares[i].pixel;
                                    glm::dvec3 sum(0.0);
                                    double weights = 0.0;
                                    for (; i < shares.size() && shares[i].pixel == pixel; ++i) {
                                        sum += glm::dvec3(map.texels[shares[i].texel]) *
                                               shares[i].solid_angle;
                                        weights += shares[i].solid_angle;
                                    }
                                    image.pixels[pixel] = sum / weights;
                                }
                            }
                        });
}

} // namespace relumine::cubemap::detail
