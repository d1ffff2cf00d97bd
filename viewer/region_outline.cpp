#include "viewer/region_outline.h"

#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <variant>

#include <glm/geometric.hpp>

namespace relumine::viewer {

namespace {

constexpr double Pi = std::numbers::pi;
/// Points of a circle, a side or an arc: enough for a smooth line on a screen.
constexpr int CirclePoints = 96;
constexpr int SidePoints = 16;

glm::dvec3 any_across(const glm::dvec3& unit) {
    const glm::dvec3 axis = std::abs(unit.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    return glm::normalize(glm::cross(unit, axis));
}

/// Appends points of the circle about `center`, from angle `begin` to `end` against `right` and
/// `up`.
void append_circle(std::vector<glm::dvec3>& line, const glm::dvec3& center, const glm::dvec3& right,
                   double radius_degrees, double begin, double end, int num_points) {
    const glm::dvec3 up = glm::cross(center, right);
    const double radius = radius_degrees * RadiansPerDegree;
    for (int i = 0; i <= num_points; ++i) {
        const double angle = begin + (end - begin) * i / num_points;
        line.push_back(std::cos(radius) * center +
                       std::sin(radius) * (std::cos(angle) * right + std::sin(angle) * up));
    }
}

/// Returns both sides of a stroke's line and round ends. This is its border wherever it does not
/// cross itself.
std::vector<glm::dvec3> stroke_outline(const cubemap::Stroke& stroke) {
    std::vector<glm::dvec3> points;
    for (const glm::dvec3& point : stroke.points) {
        const glm::dvec3 unit = glm::normalize(point);
        if (points.empty() || glm::length(points.back() - unit) > 1e-9)
            points.push_back(unit);
    }
    std::vector<glm::dvec3> line;
    if (points.size() == 1) {
        append_circle(line, points[0], any_across(points[0]), stroke.radius_degrees, 0.0, 2.0 * Pi,
                      CirclePoints);
        return line;
    }
    // The direction to the right of the line at a point, as seen from the centre of the sphere.
    const auto side = [&](std::size_t i) {
        const glm::dvec3& before = points[i > 0 ? i - 1 : i];
        const glm::dvec3& after = points[i + 1 < points.size() ? i + 1 : i];
        const glm::dvec3 across = glm::cross(after - before, points[i]);
        return glm::length(across) > 1e-12 ? glm::normalize(across) : any_across(points[i]);
    };
    const double radius = stroke.radius_degrees * RadiansPerDegree;
    for (std::size_t i = 0; i < points.size(); ++i)
        line.push_back(std::cos(radius) * points[i] + std::sin(radius) * side(i));
    append_circle(line, points.back(), side(points.size() - 1), stroke.radius_degrees, 0.0, Pi,
                  SidePoints);
    for (std::size_t i = points.size(); i-- > 0;)
        line.push_back(std::cos(radius) * points[i] - std::sin(radius) * side(i));
    append_circle(line, points.front(), -side(0), stroke.radius_degrees, 0.0, Pi, SidePoints);
    line.push_back(line.front());
    return line;
}

struct Outline {
    std::vector<glm::dvec3> operator()(const cubemap::Disc& disc) const {
        std::vector<glm::dvec3> line;
        const glm::dvec3 center = glm::normalize(disc.direction);
        append_circle(line, center, any_across(center), disc.radius_degrees, 0.0, 2.0 * Pi,
                      CirclePoints);
        return line;
    }
    std::vector<glm::dvec3> operator()(const cubemap::Rectangle& box) const {
        const BoxFrame frame = box_frame(box);
        const glm::dvec3 across =
            std::tan(0.5 * box.width_degrees * RadiansPerDegree) * frame.right;
        const glm::dvec3 upwards = std::tan(0.5 * box.height_degrees * RadiansPerDegree) * frame.up;
        const std::vector<glm::dvec3> corners = {
            frame.normal - across - upwards, frame.normal + across - upwards,
            frame.normal + across + upwards, frame.normal - across + upwards};
        return polygon(corners);
    }
    std::vector<glm::dvec3> operator()(const cubemap::Lasso& lasso) const {
        return polygon(lasso.points);
    }
    std::vector<glm::dvec3> operator()(const cubemap::Stroke& stroke) const {
        return stroke_outline(stroke);
    }

    static std::vector<glm::dvec3> polygon(std::span<const glm::dvec3> corners) {
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
};

struct Middle {
    glm::dvec3 operator()(const cubemap::Disc& disc) const {
        return glm::normalize(disc.direction);
    }
    glm::dvec3 operator()(const cubemap::Rectangle& box) const {
        return glm::normalize(box.direction);
    }
    glm::dvec3 operator()(const cubemap::Lasso& lasso) const { return mean(lasso.points); }
    glm::dvec3 operator()(const cubemap::Stroke& stroke) const { return mean(stroke.points); }

    static glm::dvec3 mean(std::span<const glm::dvec3> points) {
        glm::dvec3 sum(0.0);
        for (const glm::dvec3& point : points)
            sum += glm::normalize(point);
        return glm::length(sum) > 1e-9 ? glm::normalize(sum) : glm::normalize(points.front());
    }
};

} // namespace

BoxFrame box_frame(const cubemap::Rectangle& box) {
    const glm::dvec3 normal = glm::normalize(box.direction);
    // Upright means +Y up on the tangent plane. Straight above, the top points to +Z; straight
    // below, to -Z.
    glm::dvec3 up = glm::dvec3(0, 1, 0) - normal * normal.y;
    up = glm::length(up) > 1e-9 ? glm::normalize(up)
                                : glm::dvec3(0.0, 0.0, normal.y > 0.0 ? 1.0 : -1.0);
    const glm::dvec3 right = glm::cross(normal, up);
    const double roll = box.roll_degrees * RadiansPerDegree;
    return {.right = std::cos(roll) * right + std::sin(roll) * up,
            .up = std::cos(roll) * up - std::sin(roll) * right,
            .normal = normal};
}

glm::dvec3 middle(const cubemap::Region& region) {
    return std::visit(Middle{}, region);
}

std::vector<glm::dvec3> outline(const cubemap::Region& region) {
    return std::visit(Outline{}, region);
}

} // namespace relumine::viewer
