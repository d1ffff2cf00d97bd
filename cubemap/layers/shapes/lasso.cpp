#include "cubemap/layers/shapes/lasso.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "cubemap/layers/shapes/sphere_lines.h"

namespace relumine::cubemap {

std::vector<LayerField> Lasso::fields() {
    return {points_field(points, 3),
            {.name = "softness_degrees", .range = {0.0, 90.0}, .number = &softness_degrees}};
}

void Lasso::check() const {
    constexpr double LargestAngle = 89.9;
    const std::string expected = fmt::format("within {} degrees of their mean", LargestAngle);
    const glm::dvec3 sum = direction_sum(points);
    if (!(glm::length(sum) > 1e-9))
        refuse("points", expected, "points all around");
    for (const glm::dvec3& point : points)
        if (const double angle = angle_between(glm::normalize(point), glm::normalize(sum));
            !(angle <= LargestAngle))
            refuse("points", expected, fmt::format("one at {:.2f} degrees", angle));
}

std::vector<glm::dvec3> Lasso::outline() const {
    return polygon_line(points);
}

void Lasso::resize(const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dvec3 center = mean_direction(points);
    double widest = 0.0;
    for (const glm::dvec3& point : points)
        widest = std::max(widest, angle_between(center, point));
    const double wanted = angle_between(center, to) / std::max(angle_between(center, from), 1e-3);
    // The mean moves when points spread. So the limit is well short of the 89.9 degrees that a
    // lasso may have.
    const double scale = std::clamp(wanted, 0.01, std::max(1.0, 60.0 / std::max(widest, 1e-3)));
    for (glm::dvec3& point : points) {
        const double angle = angle_between(center, point) * RadiansPerDegree;
        const glm::dvec3 across =
            glm::normalize(point) - center * glm::dot(glm::normalize(point), center);
        if (glm::length(across) > 0.0)
            point =
                std::cos(scale * angle) * center + std::sin(scale * angle) * glm::normalize(across);
    }
}

LassoShape::LassoShape(const Lasso& lasso)
    : mean_(mean_direction(lasso.points)), first_(any_across(mean_)),
      second_(glm::cross(mean_, first_)),
      tree_(std::make_shared<ArcTree>(unit_vectors(lasso.points), true)), outline_(*tree_) {
    std::vector<glm::dvec2> on_plane;
    on_plane.reserve(lasso.points.size());
    for (const glm::dvec3& point : lasso.points) {
        const double depth = glm::dot(point, mean_);
        on_plane.emplace_back(glm::dot(point, first_) / depth, glm::dot(point, second_) / depth);
        extent_ = std::max(extent_, glm::length(glm::normalize(point) - mean_));
    }
    tree_->set_plane(on_plane);
    extent_ = std::max(extent_, HardEdge);
    band_ = std::max(chord_of(lasso.softness_degrees), HardEdge * extent_);
}

bool LassoShape::inside(const glm::dvec3& w) const {
    if (side_)
        return *side_;
    const double depth = glm::dot(w, mean_);
    if (depth < 1e-4) // the points lie within 89.9 degrees of the mean, depth 0.0017
        return false;
    return outline_.encloses({glm::dot(w, first_) / depth, glm::dot(w, second_) / depth});
}

Overlap LassoShape::bound(const glm::dvec3& w, double chord_radius) const {
    const double away = glm::length(w - mean_) - extent_;
    if (away >= chord_radius)
        return Overlap::None;
    const double reach = band_ + chord_radius;
    // The limit is a little larger than needed. So rounding cannot make a square deep inside look
    // like one at the edge.
    const double distance = std::sqrt(outline_.squared_distance(w, 1.001 * reach * reach));
    const double depth = inside(w) ? distance : -distance;
    if (depth <= -chord_radius)
        return Overlap::None;
    return depth >= band_ + chord_radius ? Overlap::All : Overlap::Part;
}

std::array<double, 1> LassoShape::ramps(const glm::dvec3& w) const {
    const double distance = std::sqrt(outline_.squared_distance(w));
    return {(inside(w) ? distance : -distance) / band_};
}

bool LassoShape::has_kink(std::size_t, const glm::dvec3& w, double chord_radius) const {
    // At a corner two edges come near. Below 1/64 of the size, a corner hides less than 1/4096. In
    // squares of more than 1/16 a sample may see a corner that lies outside the square.
    return chord_radius > extent_ / 64.0 &&
           (chord_radius > extent_ / 16.0 || outline_.several_within(w, chord_radius));
}

LassoShape LassoShape::within(const glm::dvec3& w, double chord_radius) const {
    const NearArcs outline(outline_, w, chord_radius);
    LassoShape result(*this, outline);
    // A ball that the outline does not meet lies on one side of it. The margin is for rounding.
    if (!side_ && outline.distance() > 1.000001 * chord_radius + 1e-9)
        result.side_ = inside(w);
    return result;
}

} // namespace relumine::cubemap
