#include "cubemap/layers/shapes/sphere_lines.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

namespace relumine::cubemap {

namespace {

constexpr int CirclePoints = 96;
constexpr int SidePoints = 16;

} // namespace

double chord_of(double degrees) {
    return 2.0 * std::sin(0.5 * (degrees * RadiansPerDegree));
}

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) / RadiansPerDegree;
}

glm::dvec3 turned(const glm::dvec3& direction, double degrees_about_y) {
    const double angle = degrees_about_y * std::numbers::pi / 180.0;
    return {std::cos(angle) * direction.x + std::sin(angle) * direction.z, direction.y,
            std::cos(angle) * direction.z - std::sin(angle) * direction.x};
}

glm::dvec3 direction_sum(std::span<const glm::dvec3> points) {
    glm::dvec3 sum(0.0);
    for (const glm::dvec3& point : points)
        sum += glm::normalize(point);
    return sum;
}

glm::dvec3 mean_direction(std::span<const glm::dvec3> points) {
    const glm::dvec3 sum = direction_sum(points);
    return glm::normalize(glm::length(sum) > 1e-9 ? sum : points.front());
}

std::vector<glm::dvec3> unit_vectors(std::span<const glm::dvec3> points) {
    std::vector<glm::dvec3> units;
    units.reserve(points.size());
    for (const glm::dvec3& point : points)
        units.push_back(glm::normalize(point));
    return units;
}

double distance_to(std::span<const glm::dvec3> line, const glm::dvec3& direction) {
    const glm::dvec3 w = glm::normalize(direction);
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < line.size(); ++i) {
        const glm::dvec3 a = glm::normalize(line[i]);
        const glm::dvec3 ab = glm::normalize(line[i + 1 < line.size() ? i + 1 : i]) - a;
        const double length2 = glm::dot(ab, ab);
        const double t = length2 > 0.0 ? std::clamp(glm::dot(w - a, ab) / length2, 0.0, 1.0) : 0.0;
        best = std::min(best, angle_between(a + t * ab, w));
    }
    return best;
}

glm::dvec3 any_across(const glm::dvec3& unit) {
    const glm::dvec3 axis = std::abs(unit.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    return glm::normalize(glm::cross(axis, unit));
}

void append_circle(std::vector<glm::dvec3>& line, const glm::dvec3& center, const glm::dvec3& right,
                   double radius_degrees, double begin, double end) {
    const glm::dvec3 up = glm::cross(center, right);
    const double radius = radius_degrees * RadiansPerDegree;
    const int num_points = end - begin > 1.5 * std::numbers::pi ? CirclePoints : SidePoints;
    for (int i = 0; i <= num_points; ++i) {
        const double angle = begin + (end - begin) * i / num_points;
        line.push_back(std::cos(radius) * center +
                       std::sin(radius) * (std::cos(angle) * right + std::sin(angle) * up));
    }
}

std::vector<glm::dvec3> polygon_line(std::span<const glm::dvec3> corners) {
    std::vector<glm::dvec3> line;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3& a = corners[i];
        const glm::dvec3& b = corners[(i + 1) % corners.size()];
        for (int k = 0; k < SidePoints; ++k)
            line.push_back(glm::normalize(a + (b - a) * (static_cast<double>(k) / SidePoints)));
    }
    line.push_back(line.front());
    return line;
}

} // namespace relumine::cubemap
