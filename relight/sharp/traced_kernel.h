// The inner loops of traced light, 16 receivers at a time. Vectorised with run-time dispatch.
#pragma once

#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "relight/kernels/block_kernels.h"
#include "relight/kernels/block_normals.h"
#include "relight/kernels/cluster_lights.h"

namespace relumine::relight {

/// A light that reaches some receivers of a block.
struct ReachingLight {
    const VectorIrradiance* irradiance = nullptr;
    /// Bit i stands for the block's receiver i.
    std::uint16_t reached = 0;
};

/// Returns the receivers of a block that have a direction above their horizons, a bit each.
[[nodiscard]] std::uint32_t lanes_above(const BlockNormals& normals, const glm::vec3& direction);

/// Returns the radiance for albedo 1 of a block: for each receiver, the sum of
/// irradiance.on(normal) over the lights that reach it, over pi.
[[nodiscard]] TracedRadiance traced_radiance(const BlockNormals& normals,
                                             std::span<const ReachingLight> lights);

} // namespace relumine::relight
