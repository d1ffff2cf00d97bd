// Cube maps turned by a matrix.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <glm/matrix.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/spherical_overlap.h"
#include "files/parallel.h"

namespace relumine::cubemap {

namespace {

struct Angle {
    double cosine, sine;
};

/// Exact for multiples of 90 degrees.
Angle angle_of(double degrees) {
    const double quarters = degrees / 90.0;
    if (quarters != std::round(quarters)) {
        const double angle = std::fmod(degrees, 360.0) * std::numbers::pi / 180.0;
        return {std::cos(angle), std::sin(angle)};
    }
    constexpr std::array<double, 4> Cosines = {1.0, 0.0, -1.0, 0.0};
    const auto quarter = static_cast<std::size_t>(std::fmod(std::fmod(quarters, 4.0) + 4.0, 4.0));
    return {Cosines[quarter], Cosines[(quarter + 3) % 4]};
}

/// Calls `texel_of(face, x, y)` for all texels, in parallel over rows; `worker()` makes texel_of.
template<typename Worker>
CubeMap filled(std::uint32_t resolution, const Worker& worker) {
    CubeMap result(resolution);
    files::parallel_for(files::IndexRange<std::uint32_t>(0, resolution), [&](const auto& rows) {
        auto texel_of = worker();
        for (const Face face : AllFaces) {
            for (std::uint32_t y = rows.begin(); y != rows.end(); ++y) {
                for (std::uint32_t x = 0; x < resolution; ++x)
                    result.at(face, x, y) = texel_of(face, x, y);
            }
        }
    });
    return result;
}

} // namespace

bool carries_axes_to_axes(const glm::dmat3& turn) {
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) {
            const double entry = std::abs(turn[column][row]);
            if (entry != 0.0 && entry != 1.0)
                return false;
        }
    }
    return true;
}

CubeMap turned(const CubeMap& map, const glm::dmat3& turn) {
    if (turn == glm::dmat3(1.0))
        return map;
    const glm::dmat3 source_from_destination = glm::transpose(turn);
    const double n = map.resolution;
    if (carries_axes_to_axes(turn)) {
        return filled(map.resolution, [&] {
            return [&](Face face, std::uint32_t x, std::uint32_t y) {
                const auto texel = [&](double s) {
                    return std::min(static_cast<std::uint32_t>(s * n), map.resolution - 1);
                };
                const FacePoint source = face_point(source_from_destination *
                                                    texel_direction(face, x, y, map.resolution));
                return map.at(source.face, texel(source.s), texel(source.t));
            };
        });
    }
    const bool is_mirrored = glm::determinant(turn) < 0.0;
    return filled(map.resolution, [&] {
        return [&, overlaps = TexelOverlaps(map.resolution)](Face face, std::uint32_t x,
                                                             std::uint32_t y) mutable {
            const auto corner = [&](std::uint32_t i, std::uint32_t j) {
                return source_from_destination * cube_point(face, i / n, j / n);
            };
            std::array<glm::dvec3, 4> corners = {corner(x, y), corner(x + 1, y),
                                                 corner(x + 1, y + 1), corner(x, y + 1)};
            if (is_mirrored)
                std::swap(corners[1], corners[3]);
            glm::dvec3 sum(0.0);
            double weights = 0.0;
            overlaps.find(corners,
                          [&](Face from, std::uint32_t column, std::uint32_t row, double weight) {
                              sum += glm::dvec3(map.at(from, column, row)) * weight;
                              weights += weight;
                          });
            return glm::vec3(sum / weights);
        };
    });
}

glm::dmat3 turn_about_y(double degrees) {
    const auto [cosine, sine] = angle_of(degrees);
    return {{cosine, 0.0, -sine}, {0.0, 1.0, 0.0}, {sine, 0.0, cosine}}; // columns
}

glm::dmat3 turn_about_x(double degrees) {
    const auto [cosine, sine] = angle_of(degrees);
    return {{1.0, 0.0, 0.0}, {0.0, cosine, sine}, {0.0, -sine, cosine}}; // columns
}

CubeMap rotated(const CubeMap& map, double degrees_about_y) {
    if (!std::isfinite(degrees_about_y))
        throw std::invalid_argument("rotation: expected a finite number of degrees");
    return turned(map, turn_about_y(degrees_about_y));
}

} // namespace relumine::cubemap
