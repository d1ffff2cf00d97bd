// Exposures that show lit scenes well.
#pragma once

#include <span>

#include <glm/vec3.hpp>

namespace relumine::relight {

/// Returns an exposure in stops for the brightness that a fiftieth of the radiances exceeds. It is
/// 0 where that brightness is neither dark nor far beyond white. Otherwise it makes that brightness
/// white, in half stops, from -20 to 20.
///
/// Cost:    O(n).
[[nodiscard]] float suitable_exposure_ev(std::span<const glm::vec3> radiance);

} // namespace relumine::relight
