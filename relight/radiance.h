// Which radiance light may have.
#pragma once

#include <span>

#include <glm/vec3.hpp>

namespace relumine::relight {

/// The limit on a texel's radiance. Sums over a whole sphere of such texels stay finite in float,
/// with room to spare.
inline constexpr float MaxRadiance = 1e30f;

/// Checks radiance.
///
/// Cost:    parallel, at the speed of memory.
/// Throws:  std::invalid_argument for a radiance that is NaN, negative or above MaxRadiance.
void require_radiance(std::span<const glm::vec3> texels);

} // namespace relumine::relight
