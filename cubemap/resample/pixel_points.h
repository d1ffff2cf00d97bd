// Points inside the pixels of an image, for sampling a smooth function.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "cubemap/image/image_layout.h"
#include "cubemap/image/projection.h"
#include "files/parallel.h"

namespace relumine::cubemap {

namespace detail {

/// for_each_pixel_points() for a lat-long. All rows share the longitudes, all columns the
/// latitudes.
template<typename Visit>
void for_each_lat_long_points(const ImageShape& shape, const Visit& visit) {
    // Sine and cosine of 2 points of each cell.
    const auto angles_within = [](const std::vector<double>& borders, double first, double range) {
        std::vector<glm::dvec2> points;
        for (std::size_t i = 0; i + 1 < borders.size(); ++i)
            for (const double part : {0.25, 0.75}) {
                const double angle =
                    first + range * (borders[i] + part * (borders[i + 1] - borders[i]));
                points.emplace_back(std::sin(angle), std::cos(angle));
            }
        return points;
    };
    constexpr double Pi = std::numbers::pi;
    const std::vector<glm::dvec2> longitudes =
        angles_within(cell_borders(shape.width, shape.sampling), Pi, -2.0 * Pi);
    const std::vector<glm::dvec2> polar =
        angles_within(cell_borders(shape.height, shape.sampling), 0.0, Pi);
    files::parallel_for(std::uint32_t{0}, shape.height, [&](std::uint32_t y) {
        for (std::uint32_t x = 0; x < shape.width; ++x) {
            std::array<glm::dvec3, 4> directions;
            for (std::size_t i = 0; i < 4; ++i) {
                const glm::dvec2& down = polar[std::size_t{2} * y + i / 2];
                const glm::dvec2& around = longitudes[std::size_t{2} * x + i % 2];
                directions[i] = {down.x * around.x, down.y, down.x * around.y};
            }
            visit(std::size_t{y} * shape.width + x, std::span<const glm::dvec3>(directions));
        }
    });
}

} // namespace detail

/// Calls `visit(pixel_index, std::span<const glm::dvec3>)` in parallel for each pixel that shows
/// something. The span holds the unit directions of up to four points of the pixel. The points lie
/// a quarter of a side away from the pixel's sides.
template<typename Visit>
void for_each_pixel_points(const ImageShape& shape, const Visit& visit) {
    if (shape.layout == Layout::LatLong)
        return detail::for_each_lat_long_points(shape, visit);
    const bool faces = has_faces(shape.layout);
    const Projection* const picture = projection(shape.layout);
    std::optional<FaceSquares> squares;
    if (faces)
        squares.emplace(shape.layout, shape.width, shape.height);
    const std::uint32_t width = faces ? squares->resolution() : shape.width,
                        height = faces ? squares->resolution() : shape.height;
    const std::vector<double> columns = cell_borders(width, shape.sampling),
                              rows = cell_borders(height, shape.sampling);
    const auto visit_pixel = [&](std::size_t pixel, std::uint32_t x, std::uint32_t y,
                                 const auto& direction_of) {
        std::array<glm::dvec3, 4> directions;
        std::size_t count = 0;
        for (const double dy : {0.25, 0.75}) {
            for (const double dx : {0.25, 0.75}) {
                const glm::dvec2 point(columns[x] + dx * (columns[x + 1] - columns[x]),
                                       rows[y] + dy * (rows[y + 1] - rows[y]));
                if (!faces && picture->is_disc() && glm::distance(point, glm::dvec2(0.5)) >= 0.5)
                    continue;
                directions[count++] = direction_of(point);
            }
        }
        if (count > 0)
            visit(pixel, std::span<const glm::dvec3>(directions).first(count));
    };
    files::parallel_for(files::IndexRange<std::uint32_t>(0, height), [&](const auto& range) {
        for (std::uint32_t y = range.begin(); y != range.end(); ++y) {
            if (faces) {
                for (const Face face : AllFaces) {
                    for (std::uint32_t x = 0; x < width; ++x)
                        visit_pixel(squares->pixel(face, x, y), x, y, [&](const glm::dvec2& point) {
                            return direction(face, point.x, point.y);
                        });
                }
                continue;
            }
            for (std::uint32_t x = 0; x < width; ++x)
                visit_pixel(static_cast<std::size_t>(y) * width + x, x, y,
                            [&](const glm::dvec2& point) { return picture->direction(point); });
        }
    });
}

} // namespace relumine::cubemap
