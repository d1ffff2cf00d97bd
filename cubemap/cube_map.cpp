#include "cubemap/cube_map.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "files/large_vector.h"
#include "files/parallel.h"

namespace relumine::cubemap {

namespace {

constexpr std::uint32_t MaxResolution =
    16384; // 6 R^2 texels of 12 bytes are 19 GB at this resolution

/// Returns the texel of the neighbouring face (or of this face) beyond the border at column x or
/// row y. Exactly one of x and y lies outside the face, by one.
const glm::vec3& over_the_edge(const CubeMap& map, Face face, std::int64_t x, std::int64_t y) {
    const auto resolution = static_cast<std::int64_t>(map.resolution);
    // The point just over the edge, level with the texel's centre, lies in the adjoining texel of
    // the other face.
    constexpr double JustOver = 1e-9;
    const auto coordinate = [&](std::int64_t i) {
        if (i < 0)
            return -JustOver;
        return i >= resolution ? 1.0 + JustOver
                               : (static_cast<double>(i) + 0.5) / static_cast<double>(resolution);
    };
    const FacePoint point = face_point(cube_point(face, coordinate(x), coordinate(y)));
    const auto texel = [&](double s) {
        return static_cast<std::uint32_t>(
            std::clamp(static_cast<std::int64_t>(s * static_cast<double>(resolution)),
                       std::int64_t{0}, resolution - 1));
    };
    return map.at(point.face, texel(point.s), texel(point.t));
}

/// Sums over the rows of all faces in parallel and in a fixed order. `row_sum(face, y)` returns one
/// row's part.
template<typename RowSum>
glm::dvec3 sum_over_rows(std::uint32_t resolution, const RowSum& row_sum) {
    std::vector<glm::dvec3> sums(std::size_t{NumFaces} * resolution);
    files::parallel_for(std::size_t{0}, sums.size(), [&](std::size_t row) {
        sums[row] =
            row_sum(AllFaces[row / resolution], static_cast<std::uint32_t>(row % resolution));
    });
    glm::dvec3 total(0.0);
    for (const glm::dvec3& sum : sums)
        total += sum;
    return total;
}

} // namespace

CubeMap::CubeMap(std::uint32_t face_resolution, const glm::vec3& radiance)
    : resolution(face_resolution) {
    if (face_resolution < 1 || face_resolution > MaxResolution)
        throw std::invalid_argument(
            fmt::format("cube map: expected a face resolution from 1 to {}, got {}", MaxResolution,
                        face_resolution));
    texels =
        files::large_vector(std::size_t{NumFaces} * face_resolution * face_resolution, radiance);
}

CubeMap written_over(CubeMap memory, std::uint32_t face_resolution) {
    const bool has_texels =
        memory.texels.size() == std::size_t{NumFaces} * face_resolution * face_resolution;
    return has_texels && memory.resolution == face_resolution ? std::move(memory)
                                                              : CubeMap(face_resolution);
}

glm::dvec3 texel_direction(Face face, std::uint32_t x, std::uint32_t y, std::uint32_t resolution) {
    return direction(face, (x + 0.5) / resolution, (y + 0.5) / resolution);
}

std::vector<double> texel_solid_angles(std::uint32_t resolution) {
    std::vector<double> angles(static_cast<std::size_t>(resolution) * resolution);
    const auto at = [&](std::size_t x, std::size_t y) -> double& {
        return angles[y * resolution + x];
    };
    // One eighth is computed and mirrored to the rest, so the result is exactly symmetric.
    const std::uint32_t half = (resolution + 1) / 2;
    files::parallel_for(std::uint32_t{0}, half, [&](std::uint32_t y) {
        for (std::uint32_t x = y; x < half; ++x) {
            const double n = resolution;
            const double angle = solid_angle(x / n, y / n, (x + 1) / n, (y + 1) / n);
            const std::size_t right = resolution - 1 - x, below = resolution - 1 - y;
            at(x, y) = at(right, y) = at(x, below) = at(right, below) = angle;
            at(y, x) = at(y, right) = at(below, x) = at(below, right) = angle;
        }
    });
    return angles;
}

CubeMap halved(const CubeMap& map) {
    CubeMap result(map.resolution / 2);
    const std::vector<double> solid_angles = texel_solid_angles(map.resolution);
    files::parallel_for(std::uint32_t{0}, 6 * result.resolution, [&](std::uint32_t row) {
        const auto face = static_cast<Face>(row / result.resolution);
        const std::uint32_t y = row % result.resolution;
        for (std::uint32_t x = 0; x < result.resolution; ++x) {
            glm::dvec3 sum(0.0);
            double weight = 0.0;
            for (std::uint32_t i = 0; i < 4; ++i) {
                const std::uint32_t u = 2 * x + (i & 1), v = 2 * y + (i >> 1);
                const double own = solid_angles[std::size_t{v} * map.resolution + u];
                sum += own * glm::dvec3(map.at(face, u, v));
                weight += own;
            }
            result.at(face, x, y) = glm::vec3(sum / weight);
        }
    });
    return result;
}

CubeMap halved_to(const CubeMap& map, std::uint32_t most) {
    if (map.resolution <= most || map.resolution % 2 != 0)
        return map;
    return halved_to(halved(map), most);
}

glm::vec3 sample(const CubeMap& map, const glm::vec3& direction) {
    const FacePoint point = face_point(glm::dvec3(direction));
    const auto resolution = static_cast<std::int64_t>(map.resolution);
    const double x = point.s * static_cast<double>(resolution) - 0.5;
    const double y = point.t * static_cast<double>(resolution) - 0.5;
    // As std::floor(), which is a call of a function for processors without SSE4.
    const auto floor = [](double value) {
        const auto whole = static_cast<std::int64_t>(value);
        return whole - (value < static_cast<double>(whole) ? 1 : 0);
    };
    const std::int64_t x0 = floor(x), y0 = floor(y);
    const auto fx = static_cast<float>(x - static_cast<double>(x0));
    const auto fy = static_cast<float>(y - static_cast<double>(y0));
    const auto mixed = [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
                           const glm::vec3& d) {
        return glm::mix(glm::mix(a, b, fx), glm::mix(c, d, fx), fy);
    };
    // Nearly always all four texels lie on the face.
    if (std::min(x0, y0) >= 0 && std::max(x0, y0) + 1 < resolution) {
        const glm::vec3* const above =
            &map.at(point.face, static_cast<std::uint32_t>(x0), static_cast<std::uint32_t>(y0));
        const glm::vec3* const below = above + resolution;
        return mixed(above[0], above[1], below[0], below[1]);
    }

    const auto inside = [&](std::int64_t i) {
        return i >= 0 && i < resolution;
    };
    std::array<glm::vec3, 4> corners{};
    int missing = -1; // only three texels meet at a corner of the cube
    for (int i = 0; i < 4; ++i) {
        const std::int64_t column = x0 + (i & 1), row = y0 + (i >> 1);
        glm::vec3& corner = corners[static_cast<std::size_t>(i)];
        if (inside(column) && inside(row))
            corner = map.at(point.face, static_cast<std::uint32_t>(column),
                            static_cast<std::uint32_t>(row));
        else if (inside(column) || inside(row))
            corner = over_the_edge(map, point.face, column, row);
        else
            missing = i;
    }
    if (missing >= 0) {
        const glm::vec3 mean = (corners[0] + corners[1] + corners[2] + corners[3]) / 3.0f;
        corners[static_cast<std::size_t>(missing)] = mean;
    }
    return mixed(corners[0], corners[1], corners[2], corners[3]);
}

glm::dvec3 irradiance(const CubeMap& map, const glm::dvec3& normal) {
    const std::vector<double> angles = texel_solid_angles(map.resolution);
    return sum_over_rows(map.resolution, [&](Face face, std::uint32_t y) {
        glm::dvec3 sum(0.0);
        for (std::uint32_t x = 0; x < map.resolution; ++x) {
            const double cosine = glm::dot(normal, texel_direction(face, x, y, map.resolution));
            if (cosine > 0.0)
                sum += glm::dvec3(map.at(face, x, y)) *
                       (cosine * angles[static_cast<std::size_t>(y) * map.resolution + x]);
        }
        return sum;
    });
}

glm::dvec3 total_power(const CubeMap& map) {
    const std::vector<double> angles = texel_solid_angles(map.resolution);
    return sum_over_rows(map.resolution, [&](Face face, std::uint32_t y) {
        glm::dvec3 sum(0.0);
        for (std::uint32_t x = 0; x < map.resolution; ++x)
            sum += glm::dvec3(map.at(face, x, y)) *
                   angles[static_cast<std::size_t>(y) * map.resolution + x];
        return sum;
    });
}

} // namespace relumine::cubemap
