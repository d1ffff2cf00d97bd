// Exposures that show lit scenes well.
#pragma once

#include <span>

#include <glm/vec3.hpp>

namespace relumine::relight {

/// Returns the exposure in stops that suits what is lit: its bright parts (the 95th percentile of
/// the largest channel) come out a little below white. Where most of it would stay dark, it is
/// brightened by up to a stop and a half more. Hundredths of a stop, from -100 to 100; 0 where
/// nothing is lit.
///
/// Shape:   weights is [colors.size()], or empty where all count alike.
/// Cost:    O(n log n).
[[nodiscard]] float suitable_exposure_ev(std::span<const glm::vec3> colors,
                                         std::span<const float> weights = {});

} // namespace relumine::relight
