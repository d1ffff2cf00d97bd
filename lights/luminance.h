// The luminance that lights are placed by.
#pragma once

#include <glm/vec3.hpp>

#include "cubemap/luminance.h"

namespace relumine::lights {

/// Luminance of linear RGB with the weights of [D05].
[[nodiscard]] inline double luminance(const glm::dvec3& rgb) {
    return cubemap::luminance(rgb, cubemap::MedianCutWeights);
}

} // namespace relumine::lights
