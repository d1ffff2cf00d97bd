// A cube map of radiance. Every environment becomes a cube map before it lights a scene.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "cubemap/face.h"

namespace relumine::cubemap {

/// Radiance of the sphere of directions on six faces. A texel holds the mean radiance over its
/// solid angle.
///
/// Shape:   6 x R x R texels, linear RGB.
/// Unit:    radiance; the primaries of the file are kept and read as Rec. 709.
struct CubeMap {
    /// R: the number of texels along the edge of a face.
    std::uint32_t resolution = 0;
    /// [6 * R * R] face by face, each face row by row from the top.
    std::vector<glm::vec3> texels;

    CubeMap() = default;
    /// Sets all texels to `radiance`.
    /// Throws:  std::invalid_argument unless 1 <= R <= 16384.
    explicit CubeMap(std::uint32_t face_resolution, const glm::vec3& radiance = glm::vec3(0.0f));

    /// Returns the index of texel (x, y) of a face in `texels`.
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

/// Returns the unit direction of a texel's centre.
[[nodiscard]] glm::dvec3 texel_direction(Face face, std::uint32_t x, std::uint32_t y,
                                         std::uint32_t resolution);

/// Returns the exact solid angles of the texels of one face. All faces have the same.
///
/// Shape:   [R * R] row by row.
/// Unit:    steradian.
[[nodiscard]] std::vector<double> texel_solid_angles(std::uint32_t resolution);

/// Returns the map at half its resolution, which must be even: each texel holds the mean of four
/// over their solid angles.
[[nodiscard]] CubeMap halved(const CubeMap& map);

/// Returns the map halved until it has at most `most` texels along an edge, or an odd number.
[[nodiscard]] CubeMap halved_to(const CubeMap& map, std::uint32_t most);

/// Returns the radiance seen in a direction. Values between texel centres are bilinear, also across
/// the edges of faces.
[[nodiscard]] glm::vec3 sample(const CubeMap& map, const glm::vec3& direction);

/// Returns the diffuse irradiance of a surface with unit normal n when nothing is in the way: the
/// sum of L max(n.w, 0) dw over all texels, in double.
///
/// Unit:    W/m^2 per channel if radiance is in W/(m^2 sr).
/// Cost:    O(6 R^2).
[[nodiscard]] glm::dvec3 irradiance(const CubeMap& map, const glm::dvec3& normal);

/// Returns the integral of radiance over the sphere, per channel, in double.
[[nodiscard]] glm::dvec3 total_power(const CubeMap& map);

/// Returns a map whose texels hold anything, in the memory of a map that nobody needs any more
/// where that has the same resolution, which is quicker than new memory.
[[nodiscard]] CubeMap written_over(CubeMap memory, std::uint32_t face_resolution);

/// Returns the map turned by an orthogonal matrix; mirror images are allowed. What was seen in
/// direction w is then seen in direction `turn` w. A matrix that carries axes to axes moves texels.
/// Any other mixes them, and energy is kept as in resample(); texels must be finite. `memory`
/// may be written_over().
[[nodiscard]] CubeMap turned(const CubeMap& map, const glm::dmat3& turn, CubeMap memory = {});
/// Turns a map that nobody needs any more. It is not copied where nothing turns.
[[nodiscard]] CubeMap turned(CubeMap&& map, const glm::dmat3& turn);

/// Returns true if a matrix carries axes to axes.
[[nodiscard]] bool carries_axes_to_axes(const glm::dmat3& turn);

/// Returns the turn about +Y by an angle in degrees. Light from +Z comes from +X after 90 degrees:
/// counter-clockwise seen from above, right-handed. The matrix is exact for multiples of 90
/// degrees.
[[nodiscard]] glm::dmat3 turn_about_y(double degrees);

/// Returns the turn about +X, right-handed: light from +Y comes from +Z after 90 degrees. The
/// matrix is exact for multiples of 90 degrees.
[[nodiscard]] glm::dmat3 turn_about_x(double degrees);

/// Returns the map turned by turn_about_y(), as turned().
/// Throws:  std::invalid_argument for an angle that is not finite.
[[nodiscard]] CubeMap rotated(const CubeMap& map, double degrees_about_y, CubeMap memory = {});

} // namespace relumine::cubemap
