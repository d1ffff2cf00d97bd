// Which light reaches a receiver? The transpose of relighting.
#pragma once

#include <cstdint>
#include <span>

#include "cubemap/cube_map.h"
#include "relight/bounces/bounce_light.h"
#include "relight/relighter.h"

namespace relumine::relight {

/// Returns the environment weighted by how much of it reaches the receivers: each texel's radiance
/// times the transfer of its cluster, averaged over the receivers. A sharp light has its own shadow
/// ray in place of the cluster's transfer. The integral over the sphere, cubemap::total_power(), is
/// the mean of the receivers' radiance(). With `bounces` it is the light that reaches them from
/// surfaces, too.
///
/// Unit:    radiance per sr.
/// Cost:    for up to 64 receivers their own transfer; for more, and with bounces, as
///          light_derivative() and bounce_adjoint().
/// Throws:  std::invalid_argument for no receivers, or an index out of range.
[[nodiscard]] cubemap::CubeMap contribution_map(const Relighter& relighter,
                                                std::span<const std::uint32_t> receivers,
                                                const SurfaceBounces* bounces = nullptr);

} // namespace relumine::relight
