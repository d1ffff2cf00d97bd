// Where the pixels of an environment image lie on the sphere. Layouts and samplings are named in
// environment.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
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

/// As natural_resolution() of an image.
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

/// Returns the places of all pixels of a Projection. A pixel on the rim of a disc stands for its
/// part inside the disc, with the mean direction of this part.
///
/// Shape:   [height * width].
[[nodiscard]] std::vector<PixelPlace> projected_places(const ImageShape& shape);

} // namespace detail

template<typename Visit>
void for_each_pixel(const ImageShape& shape, const Visit& visit) {
    if (shape.layout == Layout::LatLong) {
        const auto rows = detail::lat_long_rows(shape);
        const auto columns = detail::lat_long_columns(shape);
        std::size_t index = 0;
        for (const auto& row : rows) {
            for (const auto& column : columns)
                visit(index++, PixelPlace{{row.sin_polar * column.sin_longitude, row.cos_polar,
                                           row.sin_polar * column.cos_longitude},
                                          row.height * column.width});
        }
        return;
    }
    if (!has_faces(shape.layout)) {
        const std::vector<PixelPlace> places = detail::projected_places(shape);
        for (std::size_t index = 0; index < places.size(); ++index) {
            if (places[index].solid_angle > 0.0)
                visit(index, places[index]);
        }
        return;
    }
    const FaceSquares squares(shape.layout, shape.width, shape.height);
    const std::uint32_t resolution = squares.resolution();
    const std::vector<double> borders = cell_borders(resolution, shape.sampling);
    for (const Face face : AllFaces) {
        for (std::uint32_t y = 0; y < resolution; ++y) {
            for (std::uint32_t x = 0; x < resolution; ++x)
                visit(squares.pixel(face, x, y),
                      PixelPlace{
                          direction(face, sample_position(x, resolution, shape.sampling),
                                    sample_position(y, resolution, shape.sampling)),
                          solid_angle(borders[x], borders[y], borders[x + 1], borders[y + 1])});
        }
    }
}

} // namespace relumine::cubemap
