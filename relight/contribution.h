// Which light reaches a receiver? The transpose of relighting.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "relight/relighter.h"

namespace relumine::relight {

/// Returns the environment weighted by how much of it reaches the receivers: each texel's radiance
/// times the transfer of its cluster, averaged over the receivers. A sharp light has its own shadow
/// ray in place of the cluster's transfer. The integral over the sphere, cubemap::total_power(), is
/// the mean of the receivers' radiance(). Where light bounces, it is the light that reaches them
/// from surfaces, too.
///
/// Unit:    radiance per sr.
/// Cost:    O(clusters times receivers + 6 R^2); with bounces all receivers count, a second or two.
/// Throws:  std::invalid_argument for no receivers, or an index out of range.
[[nodiscard]] cubemap::CubeMap contribution_map(const Relighter& relighter,
                                                std::span<const std::uint32_t> receivers);

/// Returns the relighter of the same scene in a part of the environment, with its bounces. The
/// transfer must outlive it.
///
/// Shape:   weights is [6 * R * R] in the relighter's environment: the part of each texel, 0 to 1.
/// Cost:    as a Relighter and its first relighting.
/// Throws:  std::invalid_argument for another number of weights.
[[nodiscard]] Relighter relit_by_part(const Relighter& relighter, std::span<const float> weights);

} // namespace relumine::relight
