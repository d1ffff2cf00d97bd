#include "cubemap/layers/shapes/stroke.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "cubemap/layers/shapes/sphere_lines.h"

namespace relumine::cubemap {

std::vector<LayerField> Stroke::fields() {
    return {points_field(points, 1),
            {.name = "radius_degrees",
             .required = true,
             .range = {SmallestSize, 90.0},
             .slider = FieldRange{0.05, 90.0},
             .logarithmic_slider = true,
             .number = &radius_degrees},
            softness_field(softness)};
}

void Stroke::check() const {
    for (std::size_t i = 0; i + 1 < points.size(); ++i)
        if (angle_between(glm::normalize(points[i]), glm::normalize(points[i + 1])) > 179.999)
            refuse("points", "whose neighbours are not opposite each other",
                   fmt::format("points {} and {} that are", i, i + 1));
}

std::vector<glm::dvec3> Stroke::outline() const {
    std::vector<glm::dvec3> line, units;
    for (const glm::dvec3& unit : unit_vectors(points))
        if (units.empty() || glm::length(units.back() - unit) > 1e-9)
            units.push_back(unit);
    if (units.size() == 1) {
        append_circle(line, units[0], any_across(units[0]), radius_degrees, 0.0,
                      2.0 * std::numbers::pi);
        return line;
    }
    // The direction to the right of the line at a point, as seen from the centre of the sphere.
    const auto side = [&](std::size_t i) {
        const glm::dvec3& before = units[i > 0 ? i - 1 : i];
        const glm::dvec3& after = units[i + 1 < units.size() ? i + 1 : i];
        const glm::dvec3 across = glm::cross(after - before, units[i]);
        return glm::length(across) > 1e-12 ? glm::normalize(across) : any_across(units[i]);
    };
    const double radius = radius_degrees * RadiansPerDegree;
    for (std::size_t i = 0; i < units.size(); ++i)
        line.push_back(std::cos(radius) * units[i] + std::sin(radius) * side(i));
    append_circle(line, units.back(), side(units.size() - 1), radius_degrees, 0.0,
                  std::numbers::pi);
    for (std::size_t i = units.size(); i-- > 0;)
        line.push_back(std::cos(radius) * units[i] - std::sin(radius) * side(i));
    append_circle(line, units.front(), -side(0), radius_degrees, 0.0, std::numbers::pi);
    line.push_back(line.front());
    return line;
}

void Stroke::resize(const glm::dvec3& from, const glm::dvec3& to) {
    const double grown = distance_to(points, to) - distance_to(points, from);
    radius_degrees = std::clamp(radius_degrees + grown, 0.05, 90.0);
}

StrokeShape::StrokeShape(const Stroke& stroke)
    : outer_(chord_of(stroke.radius_degrees)),
      inner_(chord_of(stroke.radius_degrees * (1.0 - stroke.softness))),
      squared_outer_(outer_ * outer_), inverse_band_(inverse_band(outer_, inner_)),
      tree_(std::make_shared<ArcTree>(unit_vectors(stroke.points), false)), line_(*tree_) {}

Overlap StrokeShape::bound(const glm::dvec3& w, double chord_radius) const {
    const double reach = outer_ + chord_radius;
    const double squared = line_.squared_distance(w, reach * reach);
    if (squared >= reach * reach)
        return Overlap::None;
    const double room = inner_ - chord_radius;
    return room >= 0.0 && squared <= room * room ? Overlap::All : Overlap::Part;
}

std::array<double, 1> StrokeShape::ramps(const glm::dvec3& w) const {
    return {(squared_outer_ - line_.squared_distance(w)) * inverse_band_};
}

} // namespace relumine::cubemap
