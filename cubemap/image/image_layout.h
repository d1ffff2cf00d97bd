// Where the pixels of an environment image lie on the sphere. Layouts and samplings are named in
// environment.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/face.h"
#include "cubemap/image/environment.h"

namespace relumine::cubemap {

/// Size, layout and sampling of an image, without its pixels.
struct ImageShape {
    Layout layout = Layout::LatLong;
    Sampling sampling = Sampling::TexelCentres;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    bool operator==(const ImageShape&) const = default;
};

[[nodiscard]] inline ImageShape shape_of(const EnvironmentImage& image) {
    return {image.layout, image.sampling, image.width, image.height};
}

/// Returns natural_resolution() of an image of this shape.
[[nodiscard]] std::uint32_t natural_resolution(const ImageShape& shape);

/// Returns the borders of n cells side by side over [0, 1]. With TexelCentres all cells are equally
/// wide. With Borders the first and the last cell are half as wide as the others.
///
/// Shape:   [n + 1] ascending from 0 to 1.
[[nodiscard]] std::vector<double> cell_borders(std::uint32_t num_cells, Sampling sampling);

/// Returns the position in [0, 1] of sample i of n: the centre of its cell, or i / (n - 1) for
/// Borders.
[[nodiscard]] double sample_position(std::uint32_t index, std::uint32_t num_samples,
                                     Sampling sampling);

/// Returns true if the proportions suit the layout: any size for LatLong, n x 6n for Cube, 3n x 4n
/// for VerticalCross and so on, n x n for a Projection.
[[nodiscard]] bool fits(Layout layout, std::uint32_t width, std::uint32_t height);

/// Returns how many squares lie side by side and one below the other in a layout made of faces; 0 x
/// 0 for others.
[[nodiscard]] ImageSize squares_of(Layout layout);

namespace detail {

/// Column and row of a face's square in the image. `turned`: the square is turned by 180 degrees
/// against Face.
struct FaceSquare {
    std::size_t column = 0, row = 0;
    bool turned = false;
};

} // namespace detail

/// The squares of an image that hold the six faces.
class FaceSquares {
public:
    /// Throws:  std::invalid_argument for proportions that do not fit, or for a layout without
    ///          faces.
    FaceSquares(Layout layout, std::uint32_t width, std::uint32_t height);

    [[nodiscard]] std::uint32_t resolution() const { return resolution_; }

    /// Returns the index of the image's pixel that is texel (x, y) of a face.
    [[nodiscard]] std::size_t pixel(Face face, std::uint32_t x, std::uint32_t y) const {
        const detail::FaceSquare& square = squares_[static_cast<std::size_t>(face)];
        const std::size_t column = square.turned ? resolution_ - 1 - x : x;
        const std::size_t row = square.turned ? resolution_ - 1 - y : y;
        return (square.row * resolution_ + row) * width_ + square.column * resolution_ + column;
    }

private:
    std::size_t width_;
    std::uint32_t resolution_ = 0;
    std::array<detail::FaceSquare, NumFaces> squares_;
};

/// The place of a pixel on the sphere.
struct PixelPlace {
    /// Unit direction of the pixel's sample.
    glm::dvec3 direction{0.0};
    /// Solid angle of the pixel's footprint, in steradians.
    double solid_angle = 0.0;
};

/// Returns the pixel whose sample lies in a unit direction to 1e-6 of a pixel's width, if there is
/// one.
[[nodiscard]] std::optional<std::size_t> pixel_at(const ImageShape& shape,
                                                  const glm::dvec3& direction);

/// Calls `visit(pixel_index, PixelPlace)` for every pixel that shows a part of the sphere. A cross
/// also has pixels that show nothing. The order depends on the shape only.
template<typename Visit>
void for_each_pixel(const ImageShape& shape, const Visit& visit);

namespace detail {

/// One row of a lat-long image: cosine and sine of the polar angle of its samples, and the row's
/// solid angle per radian of longitude.
struct LatLongRow {
    double cos_polar, sin_polar, height;
};
[[nodiscard]] std::vector<LatLongRow> lat_long_rows(const ImageShape& shape);

/// One column of a lat-long image: sine and cosine of the longitude of its samples, and its width
/// in radians.
struct LatLongColumn {
    double sin_longitude, cos_longitude, width;
};
[[nodiscard]] std::vector<LatLongColumn> lat_long_columns(const ImageShape& shape);

/// A row of a Projection's pixels, and the one that mirrors it: their solid angles are the same. A
/// pixel on the rim of a disc stands for its part inside the disc, with the mean direction of this
/// part; one outside has no solid angle.
struct ProjectedRows {
    /// [width]
    std::vector<PixelPlace> upper, lower;

    ProjectedRows(const ImageShape& shape, std::uint32_t y);

    /// Calls `visit(pixel_index, PixelPlace)` for the pixels of both; of one in the middle row.
    template<typename Visit>
    void visit(const ImageShape& shape, std::uint32_t y, const Visit& visit) const {
        const std::uint32_t mirrored = shape.height - 1 - y;
        for (std::size_t x = 0; x < upper.size(); ++x)
            if (upper[x].solid_angle > 0.0)
                visit(std::size_t{y} * shape.width + x, upper[x]);
        for (std::size_t x = 0; x < lower.size() && mirrored != y; ++x)
            if (lower[x].solid_angle > 0.0)
                visit(std::size_t{mirrored} * shape.width + x, lower[x]);
    }
};

/// Calls `visit(y, ProjectedRows)` for the upper half of the rows. Some are found at a time, in
/// parallel.
void for_each_projected_rows(const ImageShape& shape,
                             const std::function<void(std::uint32_t, const ProjectedRows&)>& visit);

} // namespace detail

/// Pixels that show a part of the sphere, in groups whose places are found together: rows, or pairs
/// of rows that mirror each other.
///
/// Threads: safe.
class PixelRows {
public:
    explicit PixelRows(const ImageShape& shape) : shape_(shape) {
        if (shape.layout == Layout::LatLong) {
            lat_long_rows_ = detail::lat_long_rows(shape);
            lat_long_columns_ = detail::lat_long_columns(shape);
        } else if (has_faces(shape.layout)) {
            squares_.emplace(shape.layout, shape.width, shape.height);
            borders_ = cell_borders(squares_->resolution(), shape.sampling);
        }
    }

    /// Returns the number of groups.
    [[nodiscard]] std::uint32_t size() const {
        if (squares_)
            return static_cast<std::uint32_t>(NumFaces) * squares_->resolution();
        return shape_.layout == Layout::LatLong ? shape_.height : (shape_.height + 1) / 2;
    }

    /// Calls `visit(pixel_index, PixelPlace)` for the pixels of a group.
    template<typename Visit>
    void visit(std::uint32_t row, const Visit& visit) const {
        if (squares_)
            return visit_face(row, visit);
        if (shape_.layout != Layout::LatLong)
            return detail::ProjectedRows(shape_, row).visit(shape_, row, visit);
        const detail::LatLongRow& of_row = lat_long_rows_[row];
        std::size_t index = std::size_t{row} * shape_.width;
        for (const auto& column : lat_long_columns_)
            visit(index++, PixelPlace{{of_row.sin_polar * column.sin_longitude, of_row.cos_polar,
                                       of_row.sin_polar * column.cos_longitude},
                                      of_row.height * column.width});
    }

private:
    template<typename Visit>
    void visit_face(std::uint32_t row, const Visit& visit) const {
        const std::uint32_t resolution = squares_->resolution();
        const Face face = AllFaces[row / resolution];
        const std::uint32_t y = row % resolution;
        for (std::uint32_t x = 0; x < resolution; ++x)
            visit(squares_->pixel(face, x, y),
                  PixelPlace{
                      direction(face, sample_position(x, resolution, shape_.sampling),
                                sample_position(y, resolution, shape_.sampling)),
                      solid_angle(borders_[x], borders_[y], borders_[x + 1], borders_[y + 1])});
    }

    ImageShape shape_;
    std::vector<detail::LatLongRow> lat_long_rows_;
    std::vector<detail::LatLongColumn> lat_long_columns_;
    /// Set for layouts with faces.
    std::optional<FaceSquares> squares_;
    std::vector<double> borders_;
};

template<typename Visit>
void for_each_pixel(const ImageShape& shape, const Visit& visit) {
    if (shape.layout == Layout::LatLong || has_faces(shape.layout)) {
        const PixelRows rows(shape);
        for (std::uint32_t row = 0; row < rows.size(); ++row)
            rows.visit(row, visit);
        return;
    }
    detail::for_each_projected_rows(shape, [&](std::uint32_t y, const detail::ProjectedRows& rows) {
        rows.visit(shape, y, visit);
    });
}

} // namespace relumine::cubemap
