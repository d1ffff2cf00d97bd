// Cube maps turned about +Y.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <glm/matrix.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "cubemap/cube_map.h"
#include "cubemap/spherical_overlap.h"

namespace relumine::cubemap {

namespace {} // namespace

CubeMap turned(const CubeMap& map, const glm::dmat3& turn) {
    if (turn == glm::dmat3(1.0))
        return map;
    const glm::dmat3 source_from_destination = glm::transpose(turn);
    CubeMap result(map.resolution);
    const auto texel = [&](double s) {
        return std::min(static_cast<std::uint32_t>(s * map.resolution), map.resolution - 1);
    };
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, map.resolution), [&](const auto& rows) {
        for (const Face face : AllFaces) {
            for (std::uint32_t y = rows.begin(); y != rows.end(); ++y) {
                for (std::uint32_t x = 0; x < map.resolution; ++x) {
                    const FacePoint source = face_point(
                        source_from_destination * texel_direction(face, x, y, map.resolution));
                    result.at(face, x, y) = map.at(source.face, texel(source.s), texel(source.t));
                }
            }
        }
    });
    return result;
}

glm::dmat3 turn_about_y(double degrees) {
    const double quarters = degrees / 90.0;
    double cosine = 1.0, sine = 0.0;
    if (quarters == std::round(quarters)) {
        constexpr std::array<double, 4> Cosines = {1.0, 0.0, -1.0, 0.0};
        const auto quarter =
            static_cast<std::size_t>(std::fmod(std::fmod(quarters, 4.0) + 4.0, 4.0));
        cosine = Cosines[quarter];
        sine = Cosines[(quarter + 3) % 4];
    } else {
        const double angle = std::fmod(degrees, 360.0) * std::numbers::pi / 180.0;
        cosine = std::cos(angle);
        sine = std::sin(angle);
    }
    return {{cosine, 0.0, -sine}, {0.0, 1.0, 0.0}, {sine, 0.0, cosine}}; // columns
}

CubeMap rotated(const CubeMap& map, double degrees_about_y) {
    if (!std::isfinite(degrees_about_y))
        throw std::invalid_argument("rotation: expected a finite number of degrees");
    const double quarters = degrees_about_y / 90.0;
    if (quarters == std::round(quarters))
        return turned(map, turn_about_y(degrees_about_y));
    const glm::dmat3 source_from_destination = turn_about_y(-degrees_about_y);

    CubeMap result(map.resolution);
    const double n = map.resolution;
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, map.resolution), [&](const auto& rows) {
        TexelOverlaps overlaps(map.resolution);
        for (const Face face : AllFaces) {
            for (std::uint32_t y = rows.begin(); y != rows.end(); ++y) {
                for (std::uint32_t x = 0; x < map.resolution; ++x) {
                    const auto corner = [&](std::uint32_t i, std::uint32_t j) {
                        return source_from_destination * cube_point(face, i / n, j / n);
                    };
                    const std::array<glm::dvec3, 4> corners = {
                        corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)};
                    glm::dvec3 sum(0.0);
                    double weights = 0.0;
                    overlaps.find(corners, [&](Face from, std::uint32_t column, std::uint32_t row,
                                               double weight) {
                        sum += glm::dvec3(map.at(from, column, row)) * weight;
                        weights += weight;
                    });
                    result.at(face, x, y) = sum / weights;
                }
            }
        }
    });
    return result;
}

} // namespace relumine::cubemap
