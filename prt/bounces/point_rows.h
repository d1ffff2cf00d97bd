// Which surfaces points in space see: the bounces that reach them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <glm/vec3.hpp>

namespace relumine::prt {

/// The column of a hit on a surface that radiates nothing, and of a ray that meets none.
inline constexpr std::uint32_t NoEmitter = std::numeric_limits<std::uint32_t>::max();

/// What each point sees in directions that are spread evenly over the sphere, the same for all
/// points. The light that reaches it from surfaces is the sum over directions w of X(emitter) times
/// 4 pi / num_directions, from w.
struct PointRows {
    std::uint32_t num_directions = 0;
    /// [num_points][num_directions] by place: the place of the vertex that stands for what the ray
    /// meets, or NoEmitter.
    std::vector<std::uint32_t> emitters = {};

    [[nodiscard]] std::size_t num_points() const {
        return num_directions == 0 ? 0 : emitters.size() / num_directions;
    }
    bool operator==(const PointRows&) const = default;
};

/// Returns so many unit directions, evenly spread over the sphere.
/// Source:  A. Gonzalez, "Measurement of Areas on a Sphere Using Fibonacci and Latitude-Longitude
///          Lattices", Mathematical Geosciences 42, 2010.
[[nodiscard]] std::vector<glm::dvec3> even_directions(std::uint32_t count);

/// Returns into how many directions points look for a standard error of one bounce. A vertex is
/// drawn where a ray meets a triangle, so the error falls as the root of the number at worst.
[[nodiscard]] std::uint32_t num_point_directions(float tolerance);

} // namespace relumine::prt
