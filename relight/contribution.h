// Who lights this? The transpose of relighting.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "relight/relighter.h"

namespace relumine::relight {

/// The environment weighted by how much of it reaches the receivers: each texel's radiance times
/// the transfer of its cluster (or, for a sharp light, its own shadow ray), averaged over the
/// receivers. Unit: radiance per sr; the integral over the sphere, cubemap::total_power(), is the
/// mean of their radiance(). Throws std::invalid_argument for no receivers or an index out of
/// range. O(clusters times receivers + 6 R^2).
[[nodiscard]] cubemap::CubeMap contribution_map(const Relighter& relighter,
                                                std::span<const std::uint32_t> receivers);

/// The other way round: what a part of the environment gives to each receiver, [num_receivers] in
/// their own order, albedo 1. `weights`: the part, 0 to 1 for each texel, [6 * R * R] of the
/// relighter's environment.
[[nodiscard]] std::vector<glm::vec3> radiance_from(const Relighter& relighter,
                                                   std::span<const float> weights);

} // namespace relumine::relight
