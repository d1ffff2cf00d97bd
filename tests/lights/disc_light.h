// Irradiance from a distant light of some size: a uniform disc like the sun's.
#pragma once

#include <glm/vec3.hpp>

#include "lights/light_list.h"

namespace relumine::lights {

/// Returns the irradiance on a surface with a unit normal when nothing is in the way. The light is
/// a disc of its solid angle with uniform radiance, so it sets gradually. Wholly above the
/// surface's horizon the result is irradiance times the cosine. Across the horizon it is more than
/// this product, and it is zero wholly below. A light without a solid angle is a point.
[[nodiscard]] glm::dvec3 irradiance(const DistantLight& light, const glm::dvec3& normal);

} // namespace relumine::lights
