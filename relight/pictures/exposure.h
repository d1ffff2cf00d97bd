// Exposures that show lit scenes well.
#pragma once

#include <span>

#include <glm/vec3.hpp>

namespace relumine::relight {

/// In stops: 0 where that leaves the brightest fiftieth of the radiances neither dark nor far
/// beyond white; else what makes it white, in half stops, from -20 to 20. O(n).
[[nodiscard]] float suitable_exposure_ev(std::span<const glm::vec3> radiance);

} // namespace relumine::relight
