// Cube maps turned by a matrix.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>

#include <glm/matrix.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/turned_texels.h"
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

/// By any matrix.
CubeMap mixed(const CubeMap& map, const glm::dmat3& source_from_destination) {
    const TurnedTexels texels(map, source_from_destination);
    CubeMap result(map.resolution);
    files::parallel_for(files::IndexRange<std::uint32_t>(0, map.resolution), [&](const auto& rows) {
        TurnedTexels::Worker worker(map.resolution);
        for (const Face face : AllFaces)
            for (std::uint32_t y = rows.begin(); y != rows.end(); ++y)
                texels.fill(face, y, 0, map.resolution, y != rows.begin(), worker,
                            &result.at(face, 0, y));
    });
    return result;
}

/// By a matrix that carries axes to axes.
CubeMap moved(const CubeMap& map, const glm::dmat3& source_from_destination) {
    CubeMap result(map.resolution);
    const auto texel = [&](double s) {
        return std::min(static_cast<std::uint32_t>(s * map.resolution), map.resolution - 1);
    };
    files::parallel_for(std::uint32_t{0}, map.resolution, [&](std::uint32_t y) {
        for (const Face face : AllFaces)
            for (std::uint32_t x = 0; x < map.resolution; ++x) {
                const FacePoint source = face_point(source_from_destination *
                                                    texel_direction(face, x, y, map.resolution));
                result.at(face, x, y) = map.at(source.face, texel(source.s), texel(source.t));
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
    return carries_axes_to_axes(turn) ? moved(map, source_from_destination)
                                      : mixed(map, source_from_destination);
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
