#include "cubemap/layers/shapes/disc.h"

#include <algorithm>
#include <numbers>

#include "cubemap/layers/shapes/sphere_lines.h"

namespace relumine::cubemap {

std::vector<LayerField> Disc::fields() {
    return {direction_field(direction),
            {.name = "radius_degrees",
             .required = true,
             .range = {SmallestSize, 180.0},
             .slider = FieldRange{0.05, 180.0},
             .logarithmic_slider = true,
             .number = &radius_degrees},
            softness_field(softness)};
}

std::vector<glm::dvec3> Disc::outline() const {
    std::vector<glm::dvec3> line;
    const glm::dvec3 center = glm::normalize(direction);
    append_circle(line, center, any_across(center), radius_degrees, 0.0, 2.0 * std::numbers::pi);
    return line;
}

void Disc::resize(const glm::dvec3& from, const glm::dvec3& to) {
    const double grown = angle_between(direction, to) - angle_between(direction, from);
    radius_degrees = std::clamp(radius_degrees + grown, 0.05, 180.0);
}

DiscShape::DiscShape(const Disc& disc)
    : axis_(glm::normalize(disc.direction)), outer_(chord_of(disc.radius_degrees)),
      inner_(chord_of(disc.radius_degrees * (1.0 - disc.softness))),
      squared_outer_(outer_ * outer_), inverse_band_(inverse_band(outer_, inner_)),
      smallest_feature_(outer_ / 64.0) {}

} // namespace relumine::cubemap
