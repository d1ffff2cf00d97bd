#include "cubemap/layers/region_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace relumine::cubemap {

namespace {

/// Width of a hard edge's ramp relative to the size: far below a texel, far above rounding.
constexpr double HardEdge = 1e-9;

double radians(double degrees) {
    return degrees * (std::numbers::pi / 180.0);
}

double chord(double degrees) {
    return 2.0 * std::sin(0.5 * radians(degrees));
}

/// Returns 1 / (outer^2 - inner^2). The ramp of a disc is linear in squared chords, so in cosines.
double inverse_band(double outer, double inner) {
    return 1.0 / std::max((outer - inner) * (outer + inner), HardEdge * outer * outer);
}

std::vector<glm::dvec3> unit_vectors(const std::vector<glm::dvec3>& points) {
    std::vector<glm::dvec3> units;
    units.reserve(points.size());
    for (const glm::dvec3& point : points)
        units.push_back(glm::normalize(point));
    return units;
}

glm::dvec3 mean_direction(const std::vector<glm::dvec3>& points) {
    glm::dvec3 sum(0.0);
    for (const glm::dvec3& point : points)
        sum += glm::normalize(point);
    return glm::normalize(sum);
}

Overlap bound_of_depth(double depth, double flat_depth, double chord_radius) {
    if (depth <= -chord_radius)
        return Overlap::None;
    return depth >= flat_depth + chord_radius ? Overlap::All : Overlap::Part;
}

} // namespace

double smoothstep(double t) {
    const double c = std::clamp(t, 0.0, 1.0);
    return c * c * (3.0 - 2.0 * c);
}

RegionShape shape(const Region& region) {
    validate(region);
    struct Prepare {
        RegionShape operator()(const Disc& disc) const { return DiscShape(disc); }
        RegionShape operator()(const Rectangle& rectangle) const {
            return RectangleShape(rectangle);
        }
        RegionShape operator()(const Lasso& lasso) const { return LassoShape(lasso); }
        RegionShape operator()(const Stroke& stroke) const { return StrokeShape(stroke); }
    };
    return std::visit(Prepare{}, region);
}

DiscShape::DiscShape(const Disc& disc)
    : axis_(glm::normalize(disc.direction)), outer_(chord(disc.radius_degrees)),
      inner_(chord(disc.radius_degrees * (1.0 - disc.softness))), squared_outer_(outer_ * outer_),
      inverse_band_(inverse_band(outer_, inner_)), smallest_feature_(outer_ / 64.0) {}

RectangleShape::RectangleShape(const Rectangle& rectangle)
    : forward_(glm::normalize(rectangle.direction)) {
    // Right and up as seen from the centre. Straight above and below, they are as in the cube faces
    // +Y and -Y.
    glm::dvec3 right = glm::cross(forward_, glm::dvec3(0.0, 1.0, 0.0));
    const double length = glm::length(right);
    right = length > 1e-9 ? right / length : glm::dvec3(1.0, 0.0, 0.0);
    const glm::dvec3 up = glm::cross(right, forward_);
    const double roll = radians(rectangle.roll_degrees);
    right_ = std::cos(roll) * right + std::sin(roll) * up;
    up_ = std::cos(roll) * up - std::sin(roll) * right;
    half_ = {std::tan(radians(0.5 * rectangle.width_degrees)),
             std::tan(radians(0.5 * rectangle.height_degrees))};
    const double corner_depth = 1.0 / std::sqrt(1.0 + glm::dot(half_, half_));
    min_depth_ = 0.25 * corner_depth;
    smallest_feature_ = std::min(half_.x, half_.y) * corner_depth / 64.0;
    for (int i = 0; i < 2; ++i) {
        Side& side = sides_[static_cast<std::size_t>(i)];
        const double band = std::max(rectangle.softness, HardEdge) * half_[i];
        side.inner = half_[i] - band;
        side.outer_norm = 1.0 / std::sqrt(1.0 + half_[i] * half_[i]);
        side.inner_norm = 1.0 / std::sqrt(1.0 + side.inner * side.inner);
        side.inverse_band = 1.0 / band;
    }
}

Overlap RectangleShape::bound(const glm::dvec3& w, double chord_radius) const {
    const double depth = glm::dot(w, forward_);
    if (depth <= -chord_radius)
        return Overlap::None;
    const double x = std::abs(glm::dot(w, right_));
    const double y = std::abs(glm::dot(w, up_));
    // Distances to the planes through the centre and the sides.
    if ((half_.x * depth - x) * sides_[0].outer_norm <= -chord_radius ||
        (half_.y * depth - y) * sides_[1].outer_norm <= -chord_radius)
        return Overlap::None;
    if ((sides_[0].inner * depth - x) * sides_[0].inner_norm >= chord_radius &&
        (sides_[1].inner * depth - y) * sides_[1].inner_norm >= chord_radius)
        return Overlap::All;
    return Overlap::Part;
}

std::array<double, 2> RectangleShape::ramps(const glm::dvec3& w) const {
    const double depth = glm::dot(w, forward_);
    const double scale = 1.0 / std::max(depth, min_depth_);
    const double x = half_.x * depth - std::abs(glm::dot(w, right_));
    const double y = half_.y * depth - std::abs(glm::dot(w, up_));
    return {x * scale * sides_[0].inverse_band, y * scale * sides_[1].inverse_band};
}

bool RectangleShape::has_kink(std::size_t i, const glm::dvec3& w, double chord_radius) const {
    return std::abs(glm::dot(w, i == 0 ? right_ : up_)) < chord_radius;
}

glm::dvec2 RectangleShape::picture_position(const glm::dvec3& w) const {
    const double scale = 1.0 / std::max(glm::dot(w, forward_), min_depth_);
    const glm::dvec2 plane(glm::dot(w, right_) * scale / half_.x,
                           -glm::dot(w, up_) * scale / half_.y);
    return glm::clamp(0.5 * plane + 0.5, 0.0, 1.0);
}

double RectangleShape::solid_angle_of_picture(const glm::dvec3& w) const {
    const double depth = std::max(glm::dot(w, forward_), min_depth_);
    return 4.0 * half_.x * half_.y * depth * depth * depth;
}

template<>
LassoRamps<ArcTree>::LassoRamps(const Lasso& lasso) : outline_(unit_vectors(lasso.points), true) {
    const glm::dvec3 mean = mean_direction(lasso.points);
    const glm::dvec3 off =
        std::abs(mean.y) < 0.9 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(1.0, 0.0, 0.0);
    const glm::dvec3 first = glm::normalize(glm::cross(off, mean));
    plane_ = {mean, first, glm::cross(mean, first)};
    std::vector<glm::dvec2> on_plane;
    on_plane.reserve(lasso.points.size());
    double extent = 0.0;
    for (const glm::dvec3& point : lasso.points) {
        const double depth = glm::dot(point, mean);
        on_plane.emplace_back(glm::dot(point, plane_.first) / depth,
                              glm::dot(point, plane_.second) / depth);
        extent = std::max(extent, glm::length(glm::normalize(point) - mean));
    }
    outline_.set_plane(on_plane);
    size_.extent = std::max(extent, HardEdge);
    size_.band = std::max(chord(lasso.softness_degrees), HardEdge * size_.extent);
    size_.smallest_feature = size_.extent / 256.0;
}

template<typename Arcs>
bool LassoRamps<Arcs>::inside(const glm::dvec3& w) const {
    if (side_)
        return *side_;
    const double depth = glm::dot(w, plane_.mean);
    if (depth < 1e-4) // the points lie within 89.9 degrees of the mean, depth 0.0017
        return false;
    return outline_.encloses(
        {glm::dot(w, plane_.first) / depth, glm::dot(w, plane_.second) / depth});
}

template<typename Arcs>
Overlap LassoRamps<Arcs>::bound(const glm::dvec3& w, double chord_radius) const {
    const double away = glm::length(w - plane_.mean) - size_.extent;
    if (away >= chord_radius)
        return Overlap::None;
    const double reach = size_.band + chord_radius;
    // The limit is a little larger than needed. So rounding cannot make a square deep inside look
    // like one at the edge.
    const double distance = std::sqrt(outline_.squared_distance(w, 1.001 * reach * reach));
    return bound_of_depth(inside(w) ? distance : -distance, size_.band, chord_radius);
}

template<typename Arcs>
std::array<double, 1> LassoRamps<Arcs>::ramps(const glm::dvec3& w) const {
    const double distance = std::sqrt(outline_.squared_distance(w));
    return {(inside(w) ? distance : -distance) / size_.band};
}

template<typename Arcs>
bool LassoRamps<Arcs>::has_kink(std::size_t, const glm::dvec3& w, double chord_radius) const {
    // At a corner two edges come near. Below 1/64 of the size, a corner hides less than 1/4096. In
    // squares of more than 1/16 a sample may see a corner that lies outside the square.
    return chord_radius > size_.extent / 64.0 &&
           (chord_radius > size_.extent / 16.0 || outline_.several_within(w, chord_radius));
}

template<typename Arcs>
LassoRamps<NearArcs> LassoRamps<Arcs>::within(const glm::dvec3& w, double chord_radius) const {
    const NearArcs outline(outline_, w, chord_radius);
    LassoRamps<NearArcs> result(plane_, size_, outline);
    result.side_ = side_;
    // A ball that the outline does not meet lies on one side of it. The margin is for rounding.
    if (!side_ && outline.distance() > 1.000001 * chord_radius + 1e-9)
        result.side_ = inside(w);
    return result;
}

template class LassoRamps<ArcTree>;
template class LassoRamps<NearArcs>;

template<>
StrokeRamps<ArcTree>::StrokeRamps(const Stroke& stroke)
    : line_(unit_vectors(stroke.points), false) {
    size_.outer = chord(stroke.radius_degrees);
    size_.inner = chord(stroke.radius_degrees * (1.0 - stroke.softness));
    size_.squared_outer = size_.outer * size_.outer;
    size_.inverse_band = inverse_band(size_.outer, size_.inner);
    size_.smallest_feature = size_.outer / 64.0;
}

template<typename Arcs>
Overlap StrokeRamps<Arcs>::bound(const glm::dvec3& w, double chord_radius) const {
    const double reach = size_.outer + chord_radius;
    const double squared = line_.squared_distance(w, reach * reach);
    if (squared >= reach * reach)
        return Overlap::None;
    const double room = size_.inner - chord_radius;
    return room >= 0.0 && squared <= room * room ? Overlap::All : Overlap::Part;
}

template<typename Arcs>
std::array<double, 1> StrokeRamps<Arcs>::ramps(const glm::dvec3& w) const {
    return {(size_.squared_outer - line_.squared_distance(w)) * size_.inverse_band};
}

template class StrokeRamps<ArcTree>;
template class StrokeRamps<NearArcs>;

} // namespace relumine::cubemap
