// Angles and lines on the sphere of directions, for the shapes of layers.
#pragma once

#include <numbers>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace relumine::cubemap {

inline constexpr double RadiansPerDegree = std::numbers::pi / 180.0;

/// Returns the straight distance between unit directions at an angle.
[[nodiscard]] double chord_of(double degrees);

/// Returns the degrees between two directions of any length but zero, accurate near 0 and 180 too.
[[nodiscard]] double angle_between(const glm::dvec3& a, const glm::dvec3& b);

/// Returns a direction turned about +Y: +Z goes to +X at 90 degrees, as rotated() turns a map.
[[nodiscard]] glm::dvec3 turned(const glm::dvec3& direction, double degrees_about_y);

/// Returns the sum of the points' unit directions.
[[nodiscard]] glm::dvec3 direction_sum(std::span<const glm::dvec3> points);
/// Returns the points' mean, a unit direction; the first point where they are all around.
[[nodiscard]] glm::dvec3 mean_direction(std::span<const glm::dvec3> points);
[[nodiscard]] std::vector<glm::dvec3> unit_vectors(std::span<const glm::dvec3> points);

/// Returns the degrees from a direction to the nearest point of a line. Exact at its points, a
/// chord's error between them.
[[nodiscard]] double distance_to(std::span<const glm::dvec3> line, const glm::dvec3& direction);

/// Returns any unit direction across another.
[[nodiscard]] glm::dvec3 any_across(const glm::dvec3& unit);

/// Appends points of the circle about `center`, from angle `begin` to `end` against `right` and up.
/// Whole circles have enough points for a smooth line on a screen, and so have their parts.
void append_circle(std::vector<glm::dvec3>& line, const glm::dvec3& center, const glm::dvec3& right,
                   double radius_degrees, double begin, double end);

/// Returns the sides between corners as a closed line of unit directions.
[[nodiscard]] std::vector<glm::dvec3> polygon_line(std::span<const glm::dvec3> corners);

} // namespace relumine::cubemap
