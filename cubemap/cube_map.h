// A cube map of radiance: what every environment becomes before it lights anything.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "cubemap/face.h"

namespace relumine::cubemap {

/// 6 x R x R texels of linear RGB radiance (Rec. 709 primaries as in the files; not converted). A
/// texel holds the mean radiance over its solid angle.
struct CubeMap {
    /// R, texels along a face's edge
    std::uint32_t resolution = 0;
    /// [6 * R * R], face-major, then row by row from the top
    std::vector<glm::vec3> texels;

    CubeMap() = default;
    /// All texels `radiance`. Throws std::invalid_argument unless 1 <= R <= 16384.
    explicit CubeMap(std::uint32_t face_resolution, const glm::vec3& radiance = glm::vec3(0.0f));

    [[nodiscard]] std::size_t index(Face face, std::uint32_t x, std::uint32_t y) const {
        return (static_cast<std::size_t>(face) * resolution + y) * resolution + x;
    }
    [[nodiscard]] glm::vec3& at(Face face, std::uint32_t x, std::uint32_t y) {
        return texels[index(face, x, y)];
    }
    [[nodiscard]] const glm::vec3& at(Face face, std::uint32_t x, std::uint32_t y) const {
        return texels[index(face, x, y)];
    }
};

/// Unit direction of a texel's centre.
[[nodiscard]] glm::dvec3 texel_direction(Face face, std::uint32_t x, std::uint32_t y,
                                         std::uint32_t resolution);

/// Exact solid angles of one face's texels, [R * R] row by row (the same for all faces),
/// steradians.
[[nodiscard]] std::vector<double> texel_solid_angles(std::uint32_t resolution);

/// Radiance seen in a direction: bilinear between texel centres, seamless over face edges.
[[nodiscard]] glm::vec3 sample(const CubeMap& map, const glm::vec3& direction);

/// Diffuse irradiance (W/m^2 per channel if radiance is W/(m^2 sr)) on a surface of unit normal n
/// with nothing in the way: the sum over all texels of L max(n.w, 0) dw, in double. O(6 R^2).
[[nodiscard]] glm::dvec3 irradiance(const CubeMap& map, const glm::dvec3& normal);

/// The integral of radiance over the sphere, per channel, in double.
[[nodiscard]] glm::dvec3 total_power(const CubeMap& map);

/// The map turned by a matrix that carries axes to axes, mirror images among them: what was seen in
/// direction w is seen in `turn` w. Texels go to texels.
[[nodiscard]] CubeMap turned(const CubeMap& map, const glm::dmat3& turn);

/// The matrix of rotated(): exact for whole quarters.
[[nodiscard]] glm::dmat3 turn_about_y(double degrees);

/// The map turned about +Y by an angle in degrees: light that came from +Z comes from +X after 90
/// degrees (counter-clockwise seen from above, right-handed). Energy is kept as in resample().
[[nodiscard]] CubeMap rotated(const CubeMap& map, double degrees_about_y);

} // namespace relumine::cubemap
