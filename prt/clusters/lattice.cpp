#include "prt/clusters/lattice.h"

#include <cmath>

#include <glm/geometric.hpp>

namespace relumine::prt {

namespace {

// Cube coordinates [-1, 1] in steps of 2^-15 are exact integers for all samples down to MaxLevel.
constexpr double Scale = 1u << (MaxLevel + 1);
constexpr std::uint32_t BitsPerCoordinate = 20;
constexpr std::uint64_t CoordinateMask = (1u << BitsPerCoordinate) - 1;
constexpr std::int64_t Offset = 1 << (BitsPerCoordinate - 1);

std::uint64_t packed_key(double coordinate) {
    return static_cast<std::uint64_t>(std::llround(coordinate * Scale) + Offset);
}

double unpacked_key(std::uint64_t bits) {
    return static_cast<double>(static_cast<std::int64_t>(bits & CoordinateMask) - Offset) / Scale;
}

} // namespace

std::array<LatticePoint, SamplesPerCell> lattice_points(const Cell& cell) {
    std::array<LatticePoint, SamplesPerCell> points;
    const double half = 0.5 * cell.size();
    for (std::uint32_t i = 0; i < SamplesPerCell; ++i) {
        const std::uint32_t column = i % 3;
        const std::uint32_t row = i / 3;
        const glm::dvec3 point =
            cubemap::cube_point(cell.face, (2 * cell.x + column) * half, (2 * cell.y + row) * half);
        points[i] = packed_key(point.x) | packed_key(point.y) << BitsPerCoordinate |
                    packed_key(point.z) << 2 * BitsPerCoordinate;
    }
    return points;
}

glm::dvec3 place_on_cube(LatticePoint point) {
    return {unpacked_key(point), unpacked_key(point >> BitsPerCoordinate),
            unpacked_key(point >> 2 * BitsPerCoordinate)};
}

glm::vec3 direction(LatticePoint point) {
    return glm::normalize(place_on_cube(point));
}

} // namespace relumine::prt
