#include "viewer/region_edit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <variant>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "viewer/region_outline.h"

namespace relumine::viewer {

namespace {

/// Returns the rotation that takes one direction to another on the shortest way.
glm::dmat3 rotation_between(const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dvec3 a = glm::normalize(from);
    const glm::dvec3 b = glm::normalize(to);
    const glm::dvec3 axis = glm::cross(a, b);
    const double cosine = glm::dot(a, b);
    if (cosine < -0.999999) // opposite: no shortest way, and a pointer does not jump so far
        return glm::dmat3(1.0);
    // Rodrigues' formula: R = c I + [axis]x + axis axis^T / (1 + c); columns.
    const double k = 1.0 / (1.0 + cosine);
    return {glm::dvec3(cosine + k * axis.x * axis.x, axis.z + k * axis.x * axis.y,
                       -axis.y + k * axis.x * axis.z),
            glm::dvec3(-axis.z + k * axis.x * axis.y, cosine + k * axis.y * axis.y,
                       axis.x + k * axis.y * axis.z),
            glm::dvec3(axis.y + k * axis.x * axis.z, -axis.x + k * axis.y * axis.z,
                       cosine + k * axis.z * axis.z)};
}

struct Move {
    glm::dmat3 rotation;
    void operator()(cubemap::Disc& disc) const { disc.direction = rotation * disc.direction; }
    void operator()(cubemap::Rectangle& box) const { box.direction = rotation * box.direction; }
    void operator()(cubemap::Lasso& lasso) const { move(lasso.points); }
    void operator()(cubemap::Stroke& stroke) const { move(stroke.points); }
    void move(std::vector<glm::dvec3>& points) const {
        for (glm::dvec3& point : points)
            point = rotation * point;
    }
};

/// Returns the degrees from a direction to the nearest point of a line. Exact at its points, a
/// chord's error between them.
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

struct Resize {
    glm::dvec3 from, to;

    void operator()(cubemap::Disc& disc) const {
        const double grown =
            angle_between(disc.direction, to) - angle_between(disc.direction, from);
        disc.radius_degrees = std::clamp(disc.radius_degrees + grown, 0.05, 180.0);
    }
    void operator()(cubemap::Rectangle& box) const {
        const BoxFrame frame = box_frame(box);
        const glm::dvec3 before = from / std::max(glm::dot(from, frame.normal), 1e-3);
        const glm::dvec3 after = to / std::max(glm::dot(to, frame.normal), 1e-3);
        const auto resize = [](double& size_degrees, double at_from, double at_to) {
            const double half = std::tan(0.5 * size_degrees * RadiansPerDegree);
            // A corner holds two sides; the middle of a side holds only that side.
            if (std::abs(at_from) < 0.7 * half)
                return;
            const double new_half = half + std::abs(at_to) - std::abs(at_from);
            size_degrees = std::clamp(2.0 * std::atan(new_half) / RadiansPerDegree, 0.1, 170.0);
        };
        resize(box.width_degrees, glm::dot(before, frame.right), glm::dot(after, frame.right));
        resize(box.height_degrees, glm::dot(before, frame.up), glm::dot(after, frame.up));
    }
    void operator()(cubemap::Lasso& lasso) const {
        const glm::dvec3 center = middle(lasso);
        double widest = 0.0;
        for (const glm::dvec3& point : lasso.points)
            widest = std::max(widest, angle_between(center, point));
        const double wanted =
            angle_between(center, to) / std::max(angle_between(center, from), 1e-3);
        // The mean moves when points spread. So the limit is well short of the 89.9 degrees that a
        // lasso may have.
        const double scale = std::clamp(wanted, 0.01, std::max(1.0, 60.0 / std::max(widest, 1e-3)));
        for (glm::dvec3& point : lasso.points) {
            const double angle = angle_between(center, point) * RadiansPerDegree;
            const glm::dvec3 across =
                glm::normalize(point) - center * glm::dot(glm::normalize(point), center);
            if (glm::length(across) > 0.0)
                point = std::cos(scale * angle) * center +
                        std::sin(scale * angle) * glm::normalize(across);
        }
    }
    void operator()(cubemap::Stroke& stroke) const {
        const double grown = distance_to(stroke.points, to) - distance_to(stroke.points, from);
        stroke.radius_degrees = std::clamp(stroke.radius_degrees + grown, 0.05, 90.0);
    }
};

/// Returns the region with hard edges, so that all of it can be held.
cubemap::Region hard(cubemap::Region region) {
    if (auto* lasso = std::get_if<cubemap::Lasso>(&region))
        lasso->softness_degrees = 0.0;
    else if (auto* disc = std::get_if<cubemap::Disc>(&region))
        disc->softness = 0.0;
    else if (auto* box = std::get_if<cubemap::Rectangle>(&region))
        box->softness = 0.0;
    else if (auto* stroke = std::get_if<cubemap::Stroke>(&region))
        stroke->softness = 0.0;
    return region;
}

} // namespace

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) / RadiansPerDegree;
}

Grip grip_at(const cubemap::Region& region, const glm::dvec3& direction, double tolerance_degrees) {
    const std::vector<glm::dvec3> rim = outline(region);
    const bool inside = cubemap::coverage(hard(region), direction) > 0.0;
    if (distance_to(rim, direction) > tolerance_degrees)
        return inside ? Grip::Body : Grip::None;
    double size = 0.0;
    for (const glm::dvec3& point : rim)
        size = std::max(size, angle_between(middle(region), point));
    const bool near_middle = angle_between(middle(region), direction) < 0.5 * size;
    return inside && near_middle ? Grip::Body : Grip::Rim;
}

cubemap::Region moved(const cubemap::Region& region, const glm::dvec3& from, const glm::dvec3& to) {
    cubemap::Region result = region;
    std::visit(Move{rotation_between(from, to)}, result);
    return result;
}

cubemap::Region resized(const cubemap::Region& region, const glm::dvec3& from,
                        const glm::dvec3& to) {
    cubemap::Region result = region;
    std::visit(Resize{glm::normalize(from), glm::normalize(to)}, result);
    return result;
}

} // namespace relumine::viewer
