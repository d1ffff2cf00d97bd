// What a distant light of some size, a uniform disc like the sun's, does to a surface.
#pragma once

#include <glm/vec3.hpp>

#include "lights/light_list.h"

namespace relumine::lights {

/// Irradiance on a surface with a unit normal and nothing in the way. The light is a disc of its
/// solid angle and of uniform radiance, so that it sets gradually: where it is wholly above the
/// surface's horizon this is irradiance times the cosine, beside the horizon more than that, and
/// zero when all of it is below. A light without a solid angle is a point.
[[nodiscard]] glm::dvec3 irradiance(const DistantLight& light, const glm::dvec3& normal);

} // namespace relumine::lights
