// Cube maps turned about +Y.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "cubemap/cube_map.h"
#include "cubemap/spherical_overlap.h"

namespace relumine::cubemap {

namespace {

/// The turn that carries +Z towards +X.
struct Turn {
    double cosine, sine;
    [[nodiscard]] glm::dvec3 operator()(const glm::dvec3& w) const {
        return {cosine * w.x + sine * w.z, w.y, cosine * w.z - sine * w.x};
    }
};

/// Quarter turns carry texels onto texels.
CubeMap permuted(const CubeMap& map, const Turn& source_from_destination) {
    CubeMap result(map.resolution);
    const auto texel = [&](double s) {
        return std::min(static_cast<std::uint32_t>(s * map.resolution), map.resolution - 1);
    };
    for (const Face face : AllFaces) {
        for (std::uint32_t y = 0; y < map.resolution; ++y) {
            for (std::uint32_t x = 0; x < map.resolution; ++x) {
                const FacePoint source =
                    face_point(source_from_destination(texel_direction(face, x, y, map.resolution)));
                result.at(face, x, y) = map.at(source.face, texel(source.s), texel(source.t));
            }
        }
    }
    return result;
}

} // namespace

CubeMap rotated(const CubeMap& map, double degrees_about_y) {
    if (!std::isfinite(degrees_about_y))
        throw std::invalid_argument("rotation: expected a finite number of degrees");
    const double quarters = degrees_about_y / 90.0;
    if (quarters == std::round(quarters)) {
        const int quarter = static_cast<int>(std::fmod(std::fmod(quarters, 4.0) + 4.0, 4.0));
        constexpr std::array<double, 4> Cosines = {1.0, 0.0, -1.0, 0.0};
        const auto index = static_cast<std::size_t>(quarter);
        return quarter == 0 ? map : permuted(map, Turn{Cosines[index], -Cosines[(index + 3) % 4]});
    }
    const double angle = std::fmod(degrees_about_y, 360.0) * std::numbers::pi / 180.0;
    const Turn source_from_destination{std::cos(angle), -std::sin(angle)};

    CubeMap result(map.resolution);
    const double n = map.resolution;
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, map.resolution), [&](const auto& rows) {
        TexelOverlaps overlaps(map.resolution);
        for (const Face face : AllFaces) {
            for (std::uint32_t y = rows.begin(); y != rows.end(); ++y) {
                for (std::uint32_t x = 0; x < map.resolution; ++x) {
                    const auto corner = [&](std::uint32_t i, std::uint32_t j) {
                        return source_from_destination(cube_point(face, i / n, j / n));
                    };
                    const std::array<glm::dvec3, 4> corners = {corner(x, y), corner(x + 1, y),
                                                               corner(x + 1, y + 1), corner(x, y + 1)};
                    glm::dvec3 sum(0.0);
                    double weights = 0.0;
                    overlaps.find(corners,
                                  [&](Face from, std::uint32_t column, std::uint32_t row, double weight) {
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
