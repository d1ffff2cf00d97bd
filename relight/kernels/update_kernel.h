// The inner loops of updates: changed clusters of a few, 16 receivers at a time. Vectorised with
// run-time dispatch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "relight/kernels/block_kernels.h"
#include "relight/kernels/kernel_lights.h"

namespace relumine::relight {

/// Adds the effect of changed clusters to the light of a tile [JN, Eq. 15]. Returns the blocks that
/// see a changed cluster: bit b for the tile's block b.
///
/// Shape:   light holds all blocks of the scene.
std::uint64_t update_tile(const BlockScene& scene, std::size_t tile, const LightChanges& changes,
                          std::span<BlockLight> light);

} // namespace relumine::relight
