// Cube maps turned by a matrix.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <glm/matrix.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/spherical_overlap.h"
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

/// A texel by itself.
glm::vec3 mixed_texel(const CubeMap& map, const glm::dmat3& source_from_destination, Face face,
                      std::uint32_t x, std::uint32_t y, TexelOverlaps& overlaps) {
    const double n = map.resolution;
    const auto corner = [&](std::uint32_t i, std::uint32_t j) {
        return source_from_destination * cube_point(face, i / n, j / n);
    };
    std::array<glm::dvec3, 4> corners = {corner(x, y), corner(x + 1, y), corner(x + 1, y + 1),
                                         corner(x, y + 1)};
    if (glm::determinant(source_from_destination) < 0.0)
        std::swap(corners[1], corners[3]);
    glm::dvec3 sum(0.0);
    double weights = 0.0;
    overlaps.find(corners, [&](Face from, std::uint32_t column, std::uint32_t row, double weight) {
        sum += glm::dvec3(map.at(from, column, row)) * weight;
        weights += weight;
    });
    return glm::vec3(sum / weights);
}

/// By any matrix, texel by texel. In coarse maps TexelOverlaps takes the solid angle in finer cells
/// than texels.
void mix_coarse(const CubeMap& map, const glm::dmat3& source_from_destination, CubeMap& result) {
    const std::uint32_t r = map.resolution;
    files::parallel_for(files::IndexRange<std::size_t>(0, NumFaces * r), [&](const auto& rows) {
        TexelOverlaps overlaps(r);
        for (std::size_t i = rows.begin(); i != rows.end(); ++i) {
            const Face face = AllFaces[i / r];
            const auto y = static_cast<std::uint32_t>(i % r);
            for (std::uint32_t x = 0; x < r; ++x)
                result.at(face, x, y) =
                    mixed_texel(map, source_from_destination, face, x, y, overlaps);
        }
    });
}

/// By a matrix that carries axes to axes.
void move(const CubeMap& map, const glm::dmat3& source_from_destination, CubeMap& result) {
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

CubeMap turned(const CubeMap& map, const glm::dmat3& turn, CubeMap memory) {
    if (turn == glm::dmat3(1.0))
        return map;
    const glm::dmat3 source_from_destination = glm::transpose(turn);
    memory = written_over(std::move(memory), map.resolution);
    if (carries_axes_to_axes(turn))
        move(map, source_from_destination, memory);
    else if (map.resolution < TurnedTexels::MinResolution)
        mix_coarse(map, source_from_destination, memory);
    else
        TurnedTexels(map, source_from_destination).fill_all(memory);
    return memory;
}

CubeMap turned(CubeMap&& map, const glm::dmat3& turn) {
    return turn == glm::dmat3(1.0) ? std::move(map) : turned(std::as_const(map), turn);
}

glm::dmat3 turn_about_y(double degrees) {
    const auto [cosine, sine] = angle_of(degrees);
    return {{cosine, 0.0, -sine}, {0.0, 1.0, 0.0}, {sine, 0.0, cosine}}; // columns
}

glm::dmat3 turn_about_x(double degrees) {
    const auto [cosine, sine] = angle_of(degrees);
    return {{1.0, 0.0, 0.0}, {0.0, cosine, sine}, {0.0, -sine, cosine}}; // columns
}

CubeMap rotated(const CubeMap& map, double degrees_about_y, CubeMap memory) {
    if (!std::isfinite(degrees_about_y))
        throw std::invalid_argument("rotation: expected a finite number of degrees");
    return turned(map, turn_about_y(degrees_about_y), std::move(memory));
}

} // namespace relumine::cubemap
