// The inner loops of harmonics: clusters' coefficients times visible counts, 16 receivers at a
// time. Vectorised with run-time dispatch.
#pragma once

#include <cstddef>
#include <cstdint>

#include "prt/receivers/block_size.h"
#include "relight/harmonics/cluster_harmonics.h"
#include "relight/kernels/block_kernels.h"

namespace relumine::relight {

/// The coefficients of all blocks, in two parts as BlockLight has them. The sum of both is the
/// light: 16 visible + mixed.
struct HarmonicBlocks {
    /// [num_blocks * stride]
    double* visible;
    /// [num_blocks * stride * 16] [block][channel][coefficient][receiver].
    double* mixed;
};

/// Sums all clusters for blocks of a tile: c/16 times the part of the cluster that is above the
/// horizon, times its coefficients. Bit b of `chosen` stands for the tile's block b.
///
/// What a block sees in part adds up by HarmonicGroups: first the fluxes of a group's clusters,
/// then the group's basis functions times their sum.
void light_harmonics(const BlockScene& scene, std::size_t tile, const ClusterHarmonics& lights,
                     std::uint64_t chosen, const HarmonicBlocks& blocks);

/// Adds the effect of changed clusters to the blocks of a tile. Returns the blocks that see one.
std::uint64_t update_harmonics(const BlockScene& scene, std::size_t tile,
                               const ClusterHarmonics& lights, const HarmonicChanges& changes,
                               const HarmonicBlocks& blocks);

} // namespace relumine::relight
