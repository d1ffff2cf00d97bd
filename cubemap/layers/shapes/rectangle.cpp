#include "cubemap/layers/shapes/rectangle.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "cubemap/layers/shapes/sphere_lines.h"

namespace relumine::cubemap {

std::vector<LayerField> Rectangle::fields() {
    const auto side = [](std::string_view name, double& degrees) -> LayerField {
        return {.name = name,
                .required = true,
                .range = {SmallestSize, 180.0},
                .below_end = true,
                .slider = FieldRange{0.1, 170.0},
                .number = &degrees};
    };
    return {direction_field(direction),
            side("width_degrees", width_degrees),
            side("height_degrees", height_degrees),
            {.name = "roll_degrees", .slider = FieldRange{-180.0, 180.0}, .number = &roll_degrees},
            softness_field(softness)};
}

std::vector<glm::dvec3> Rectangle::outline() const {
    const RectangleFrame frame(*this);
    const glm::dvec3 across = frame.half.x * frame.right, upwards = frame.half.y * frame.up;
    const std::array<glm::dvec3, 4> corners = {
        frame.forward - across - upwards, frame.forward + across - upwards,
        frame.forward + across + upwards, frame.forward - across + upwards};
    return polygon_line(corners);
}

void Rectangle::resize(const glm::dvec3& from, const glm::dvec3& to) {
    const RectangleFrame frame(*this);
    const glm::dvec3 before = from / std::max(glm::dot(from, frame.forward), 1e-3);
    const glm::dvec3 after = to / std::max(glm::dot(to, frame.forward), 1e-3);
    const auto resize_side = [&](double& size_degrees, double half, const glm::dvec3& axis) {
        const double at_from = std::abs(glm::dot(before, axis));
        // A corner holds two sides; the middle of a side holds only that side.
        if (at_from < 0.7 * half)
            return;
        const double new_half = half + std::abs(glm::dot(after, axis)) - at_from;
        size_degrees = std::clamp(2.0 * std::atan(new_half) / RadiansPerDegree, 0.1, 170.0);
    };
    resize_side(width_degrees, frame.half.x, frame.right);
    resize_side(height_degrees, frame.half.y, frame.up);
}

void Rectangle::turn_upright(double degrees_about_y) {
    if (direction.x == 0.0 && direction.z == 0.0)
        roll_degrees += direction.y > 0.0 ? -degrees_about_y : degrees_about_y;
}

RectangleFrame::RectangleFrame(const Rectangle& rectangle)
    : forward(glm::normalize(rectangle.direction)),
      half(std::tan(0.5 * rectangle.width_degrees * RadiansPerDegree),
           std::tan(0.5 * rectangle.height_degrees * RadiansPerDegree)) {
    // Right and up as seen from the centre. Straight above and below, they are as in the cube faces
    // +Y and -Y.
    glm::dvec3 level = glm::cross(forward, glm::dvec3(0.0, 1.0, 0.0));
    const double length = glm::length(level);
    level = length > 1e-9 ? level / length : glm::dvec3(1.0, 0.0, 0.0);
    const glm::dvec3 upright = glm::cross(level, forward);
    const double roll = rectangle.roll_degrees * RadiansPerDegree;
    right = std::cos(roll) * level + std::sin(roll) * upright;
    up = std::cos(roll) * upright - std::sin(roll) * level;
}

RectangleShape::RectangleShape(const Rectangle& rectangle) : frame_(rectangle) {
    const glm::dvec2& half = frame_.half;
    const double corner_depth = 1.0 / std::sqrt(1.0 + glm::dot(half, half));
    min_depth_ = 0.25 * corner_depth;
    smallest_feature_ = std::min(half.x, half.y) * corner_depth / 64.0;
    for (int i = 0; i < 2; ++i) {
        Side& side = sides_[static_cast<std::size_t>(i)];
        const double band = std::max(rectangle.softness, HardEdge) * half[i];
        side.inner = half[i] - band;
        side.outer_norm = 1.0 / std::sqrt(1.0 + half[i] * half[i]);
        side.inner_norm = 1.0 / std::sqrt(1.0 + side.inner * side.inner);
        side.inverse_band = 1.0 / band;
    }
}

Overlap RectangleShape::bound(const glm::dvec3& w, double chord_radius) const {
    const double depth = glm::dot(w, frame_.forward);
    if (depth <= -chord_radius)
        return Overlap::None;
    const double x = std::abs(glm::dot(w, frame_.right));
    const double y = std::abs(glm::dot(w, frame_.up));
    // Distances to the planes through the centre and the sides.
    if ((frame_.half.x * depth - x) * sides_[0].outer_norm <= -chord_radius ||
        (frame_.half.y * depth - y) * sides_[1].outer_norm <= -chord_radius)
        return Overlap::None;
    if ((sides_[0].inner * depth - x) * sides_[0].inner_norm >= chord_radius &&
        (sides_[1].inner * depth - y) * sides_[1].inner_norm >= chord_radius)
        return Overlap::All;
    return Overlap::Part;
}

std::array<double, 2> RectangleShape::ramps(const glm::dvec3& w) const {
    const double depth = glm::dot(w, frame_.forward);
    const double scale = 1.0 / std::max(depth, min_depth_);
    const double x = frame_.half.x * depth - std::abs(glm::dot(w, frame_.right));
    const double y = frame_.half.y * depth - std::abs(glm::dot(w, frame_.up));
    return {x * scale * sides_[0].inverse_band, y * scale * sides_[1].inverse_band};
}

bool RectangleShape::has_kink(std::size_t i, const glm::dvec3& w, double chord_radius) const {
    return std::abs(glm::dot(w, i == 0 ? frame_.right : frame_.up)) < chord_radius;
}

glm::dvec2 RectangleShape::picture_position(const glm::dvec3& w) const {
    const double scale = 1.0 / std::max(glm::dot(w, frame_.forward), min_depth_);
    const glm::dvec2 plane(glm::dot(w, frame_.right) * scale / frame_.half.x,
                           -glm::dot(w, frame_.up) * scale / frame_.half.y);
    return glm::clamp(0.5 * plane + 0.5, 0.0, 1.0);
}

double RectangleShape::solid_angle_of_picture(const glm::dvec3& w) const {
    const double depth = std::max(glm::dot(w, frame_.forward), min_depth_);
    return 4.0 * frame_.half.x * frame_.half.y * depth * depth * depth;
}

} // namespace relumine::cubemap
