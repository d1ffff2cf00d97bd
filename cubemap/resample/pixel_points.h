// Points inside the pixels of an image, for sampling a smooth function.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
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

/// Two places within each cell between borders.
[[nodiscard]] inline std::vector<double> quarters_within(const std::vector<double>& borders) {
    std::vector<double> places;
    for (std::size_t i = 0; i + 1 < borders.size(); ++i)
        for (const double part : {0.25, 0.75})
            places.push_back(borders[i] + part * (borders[i + 1] - borders[i]));
    return places;
}

/// for_each_pixel_points() for a lat-long. All rows share the longitudes, all columns the
/// latitudes.
template<typename Visit>
void for_each_lat_long_points(const ImageShape& shape, const Visit& visit) {
    // Sine and cosine of 2 points of each cell.
    const auto angles_within = [](const std::vector<double>& borders, double first, double range) {
        std::vector<glm::dvec2> points;
        for (const double place : quarters_within(borders)) {
            const double angle = first + range * place;
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

/// for_each_pixel_points() for layouts with faces. All faces share the lengths of their directions.
template<typename Visit>
void for_each_face_points(const ImageShape& shape, const Visit& visit) {
    const FaceSquares squares(shape.layout, shape.width, shape.height);
    const std::uint32_t resolution = squares.resolution();
    const std::vector<double> places = quarters_within(cell_borders(resolution, shape.sampling));
    files::parallel_for(std::uint32_t{0}, resolution, [&](std::uint32_t y) {
        for (const Face face : AllFaces) {
            const FaceAxes axes(face);
            for (std::uint32_t x = 0; x < resolution; ++x) {
                std::array<glm::dvec3, 4> directions;
                for (std::size_t i = 0; i < 4; ++i)
                    directions[i] = axes.direction(2.0 * places[std::size_t{2} * x + i % 2] - 1.0,
                                                   2.0 * places[std::size_t{2} * y + i / 2] - 1.0);
                visit(squares.pixel(face, x, y), std::span<const glm::dvec3>(directions));
            }
        }
    });
}

/// for_each_pixel_points() for a Projection.
template<typename Visit>
void for_each_projected_points(const ImageShape& shape, const Visit& visit) {
    const Projection& picture = *projection(shape.layout);
    const std::vector<double> columns = quarters_within(cell_borders(shape.width, shape.sampling)),
                              rows = quarters_within(cell_borders(shape.height, shape.sampling));
    files::parallel_for(std::uint32_t{0}, shape.height, [&](std::uint32_t y) {
        for (std::uint32_t x = 0; x < shape.width; ++x) {
            std::array<glm::dvec3, 4> directions;
            std::size_t count = 0;
            for (std::size_t i = 0; i < 4; ++i) {
                const glm::dvec2 point(columns[std::size_t{2} * x + i % 2],
                                       rows[std::size_t{2} * y + i / 2]);
                if (!picture.is_disc() || glm::distance(point, glm::dvec2(0.5)) < 0.5)
                    directions[count++] = picture.direction(point);
            }
            if (count > 0)
                visit(std::size_t{y} * shape.width + x,
                      std::span<const glm::dvec3>(directions).first(count));
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
        detail::for_each_lat_long_points(shape, visit);
    else if (has_faces(shape.layout))
        detail::for_each_face_points(shape, visit);
    else
        detail::for_each_projected_points(shape, visit);
}

} // namespace relumine::cubemap
