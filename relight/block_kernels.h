// The inner loops of relighting: clusters' light times visible counts, 16 receivers at a time.
// Vectorised with run-time dispatch.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/transfer.h"
#include "relight/block_normals.h"
#include "relight/cluster_lights.h"
#include "relight/tile_words.h"

namespace relumine::relight {

/// Light of the clusters as the kernels read it: per cluster the red, green and blue vector
/// irradiance over 16 pi, rounded to float. Full sums and updates use the very same rounded
/// numbers.
struct ClusterLights {
    static constexpr std::size_t Stride = 9;
    /// [num_clusters * 9] red x y z, green x y z, blue x y z.
    std::vector<float> vectors;
    /// [(num_clusters + 1) * 9] sums of `vectors` over the clusters before each one.
    std::vector<double> prefix;

    explicit ClusterLights(std::size_t num_clusters);
    void set(std::size_t cluster, const VectorIrradiance& irradiance);
    /// Fills `prefix`, which only light_tile() reads.
    void sum_prefix();
};

/// The light that a block of 16 receivers has received, in two parts. Clusters that all 16 see
/// whole, above their horizons, add up to one vector. Other clusters add up per receiver.
///
/// The sums consist of float sums over 64 clusters each, added in double. An update subtracts such
/// a float sum and adds the new one. So nothing remains of a light that is gone, not even its
/// rounding.
struct alignas(64) BlockLight {
    /// Vector irradiance over 16 pi.
    std::array<double, ClusterLights::Stride> visible{};
    /// Radiance [channel][receiver].
    std::array<std::array<double, prt::BlockSize>, 3> mixed{};
};

/// Changed clusters among the 64 that share a word of VisibleCounts.
struct ChangedWord {
    /// Index of the cluster / 64.
    std::uint32_t word = 0;
    /// Bit cluster % 64 is set for each changed cluster.
    std::uint64_t clusters = 0;
};

/// Outgoing radiance of a block's receivers for albedo 1, [channel][receiver].
struct alignas(64) BlockRadiance {
    std::array<std::array<float, prt::BlockSize>, 3> channels{};

    [[nodiscard]] glm::vec3 of(std::size_t receiver) const {
        return {channels[0][receiver], channels[1][receiver], channels[2][receiver]};
    }
};

/// Radiance of a block's receivers that does not come from clusters, for albedo 1,
/// [channel][receiver].
struct alignas(64) TracedRadiance {
    std::array<std::array<double, prt::BlockSize>, 3> channels{};
};

/// Sums both parts of a block's light, never below zero, and adds `traced` (null: nothing).
void block_radiance(const BlockNormals& normals, const BlockLight& light,
                    const TracedRadiance* traced, BlockRadiance& radiance);

/// The scene's data for lighting blocks. Sums of a tile's blocks need nothing else.
struct BlockScene {
    const prt::VisibleCounts& counts;
    /// From tile_words().
    const TileWords& words;
    /// [num_blocks]
    std::span<const BlockNormals> normals;
};

/// Lights the blocks of a tile from all clusters [JN, Eq. 8]: sum over C of c/16 max(n.E_C, 0)/pi.
///
/// Shape:   light holds all blocks of the scene.
void light_tile(const BlockScene& scene, std::size_t tile, const ClusterLights& lights,
                std::span<BlockLight> light);

/// Adds the effect of changed clusters to the light of a tile [JN, Eq. 15]. `before` and `after`
/// are ClusterLights::vectors of all clusters; they differ in no other cluster. Returns the blocks
/// that see a changed cluster: bit b for the tile's block b.
std::uint64_t update_tile(const BlockScene& scene, std::size_t tile,
                          std::span<const ChangedWord> changes, std::span<const float> before,
                          std::span<const float> after, std::span<BlockLight> light);

} // namespace relumine::relight
