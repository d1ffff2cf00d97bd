// The inner loop of glossy relighting: light of cells times quantised transfer, 16 receivers at a
// time. Vectorised with run-time dispatch.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "prt/transfer/glossy_transfer.h"
#include "relight/kernels/block_kernels.h"

namespace relumine::relight {

/// Radiance of a block's receivers through each lobe, without colours.
using GlossyLight = std::array<BlockRadiance, prt::NumGlossyLobes>;

/// Lights one block through one lobe [JN, Eq. 8]: sum over its cells of light times transfer.
/// `light` is LightPyramid::light().
void light_block(const prt::LobeCuts& cuts, std::size_t block, std::span<const float> light,
                 BlockRadiance& radiance);

} // namespace relumine::relight
