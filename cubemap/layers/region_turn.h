// Turns regions and directions together with the environment below them.
#pragma once

#include <glm/vec3.hpp>

#include "cubemap/layers/light_layer.h"

namespace relumine::cubemap {

/// Returns a direction turned about +Y: +Z goes to +X at 90 degrees, as rotated() turns a map.
[[nodiscard]] glm::dvec3 turned(const glm::dvec3& direction, double degrees_about_y);

/// Returns a region turned about +Y. A rectangle stays upright. Straight above or below, where
/// upright is a convention, a rectangle turns on the spot.
[[nodiscard]] Region turned(const Region& region, double degrees_about_y);

} // namespace relumine::cubemap
