// Borders of light layers as lines of directions.
#pragma once

#include <numbers>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/layers/light_layer.h"

namespace relumine::viewer {

inline constexpr double RadiansPerDegree = std::numbers::pi / 180.0;

/// Unit axes of a soft box, seen from the centre of the sphere.
struct BoxFrame {
    glm::dvec3 right, up, normal;
};

[[nodiscard]] BoxFrame box_frame(const cubemap::Rectangle& box);

/// Returns a region's middle, a unit direction. The middle of a lasso or a stroke is the mean of
/// its points.
[[nodiscard]] glm::dvec3 middle(const cubemap::Region& region);

/// Returns the region's border as a closed line of unit directions. The first one is repeated at
/// the end.
[[nodiscard]] std::vector<glm::dvec3> outline(const cubemap::Region& region);

} // namespace relumine::viewer
