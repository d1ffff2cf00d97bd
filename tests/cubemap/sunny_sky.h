// The sky that conversions are measured on.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"

namespace relumine::cubemap {

/// Grey and smooth, R = 256.
inline CubeMap smooth_sky() {
    CubeMap map(256);
    for (const Face face : AllFaces)
        for (std::uint32_t y = 0; y < map.resolution; ++y)
            for (std::uint32_t x = 0; x < map.resolution; ++x) {
                const glm::dvec3 w = texel_direction(face, x, y, map.resolution);
                map.at(face, x, y) =
                    glm::vec3(static_cast<float>(1.0 + 0.6 * w.y + 0.3 * std::sin(7.0 * w.x)));
            }
    return map;
}

/// Adds the power of a sun of 0.53 degrees and radiance 1e5 to one texel, times `color`.
/// `direction` is of unit length.
inline void add_sun(CubeMap& map, const glm::dvec3& direction,
                    const glm::vec3& color = glm::vec3(1.0f)) {
    constexpr double Radius = 0.265 * std::numbers::pi / 180.0;
    constexpr double Radiance = 1e5;
    const double sun = 2.0 * std::numbers::pi * (1.0 - std::cos(Radius));
    const FacePoint point = face_point(direction);
    const double r = map.resolution;
    const auto x = static_cast<std::uint32_t>(point.s * r);
    const auto y = static_cast<std::uint32_t>(point.t * r);
    const double texel = solid_angle(x / r, y / r, (x + 1) / r, (y + 1) / r);
    map.at(point.face, x, y) += color * static_cast<float>(Radiance * sun / texel);
}

/// 32 normals evenly over the sphere.
inline std::vector<glm::dvec3> even_normals() {
    std::vector<glm::dvec3> normals;
    for (int i = 0; i < 32; ++i) {
        const double y = 1.0 - (2 * i + 1) / 32.0, angle = i * 2.39996322972865332,
                     across = std::sqrt(1.0 - y * y);
        normals.emplace_back(across * std::cos(angle), y, across * std::sin(angle));
    }
    return normals;
}

} // namespace relumine::cubemap
