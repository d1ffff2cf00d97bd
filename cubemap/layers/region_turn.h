// Regions and directions turned with the environment below them.
#pragma once

#include <glm/vec3.hpp>

#include "cubemap/layers/light_layer.h"

namespace relumine::cubemap {

/// Turned about +Y: +Z goes to +X at 90 degrees, as rotated() turns a map.
[[nodiscard]] glm::dvec3 turned(const glm::dvec3& direction, double degrees_about_y);

/// A rectangle stays upright; straight above or below, where upright is a convention, it turns on
/// the spot.
[[nodiscard]] Region turned(const Region& region, double degrees_about_y);

} // namespace relumine::cubemap
