// The inner loops of relighting: clusters' light times visible counts, 16 receivers at a time.
// Vectorised with run-time dispatch.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "prt/transfer/transfer.h"
#include "relight/kernels/block_normals.h"
#include "relight/kernels/kernel_lights.h"
#include "relight/kernels/tile_words.h"

namespace relumine::relight {

/// Whether a block that is updated must be summed anew.
struct BlockBrightness {
    /// Brightness when the block was last summed, and the largest since then.
    double summed = 0.0;
    double largest = 0.0;

    /// Takes note of the brightness after a sum.
    void set_summed(double brightness) { summed = largest = brightness; }
    /// Takes note of the brightness after an update. Returns whether the block has dimmed so far
    /// that roundings of brighter light may show, and it must be summed anew: to a 64th of what was
    /// summed in float, or to 2^-30 of what was added in double.
    [[nodiscard]] bool has_dimmed_to(double brightness) {
        largest = std::max(largest, brightness);
        return brightness < summed / 64.0 || brightness < 0x1p-30 * largest;
    }
};

/// The light that a block of 16 receivers has received, in two parts. Clusters that all 16 see
/// whole, above their horizons, add up to one vector. Other clusters add up per receiver.
///
/// light_tile() sums in float for a while before it adds to double. update_tile() adds differences
/// of floats, exactly but for the roundings of double. So lights may come and go as often as they
/// like.
struct alignas(64) BlockLight {
    /// Radiance [channel][receiver].
    std::array<std::array<double, prt::BlockSize>, 3> mixed{};
    /// Vector irradiance over 16 pi.
    std::array<double, ClusterLights::Stride> visible{};
    BlockBrightness brightness = {};
};

/// Outgoing radiance of a block's receivers for albedo 1, [channel][receiver]. Kernels write all of
/// it, so nothing is there before.
struct alignas(64) BlockRadiance {
    std::array<std::array<float, prt::BlockSize>, 3> channels;

    [[nodiscard]] glm::vec3 of(std::size_t receiver) const {
        return {channels[0][receiver], channels[1][receiver], channels[2][receiver]};
    }
};

/// Radiance of a block's receivers that does not come from clusters, for albedo 1,
/// [channel][receiver].
struct alignas(64) TracedRadiance {
    std::array<std::array<double, prt::BlockSize>, 3> channels{};
};

/// Sums both parts of a block's light, never below zero, and adds `traced` (null: nothing). Returns
/// the block's brightness: the largest entry of either part, whatever its sign.
double block_radiance(const BlockNormals& normals, const BlockLight& light,
                      const TracedRadiance* traced, BlockRadiance& radiance);

/// The scene's data for lighting blocks. Sums of a tile's blocks need nothing else.
struct BlockScene {
    const prt::VisibleCounts& counts;
    /// From tile_words().
    const TileWords& words;
    /// [num_blocks]
    std::span<const BlockNormals> normals;
};

/// Lights blocks of a tile from all clusters [JN, Eq. 8]: sum over C of c/16 max(n.E_C, 0)/pi. Bit
/// b of `blocks` stands for the tile's block b.
///
/// Shape:   light holds all blocks of the scene.
void light_tile(const BlockScene& scene, std::size_t tile, const ClusterLights& lights,
                std::span<BlockLight> light, std::uint64_t blocks = ~std::uint64_t{0});

} // namespace relumine::relight
