// The inner loop of the adjoint: the walk of light_tile(), backwards. Receivers' weights are summed
// into clusters. Vectorised with run-time dispatch.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "relight/kernels/block_kernels.h"

namespace relumine::relight {

/// Sums of weights times normals over some receivers, [channel x axis].
inline constexpr std::size_t NumWeightSums = 9;
using WeightSums = std::array<double, NumWeightSums>;

/// Weights of receivers, in blocks.
struct BlockWeights {
    struct alignas(64) Block {
        /// [channel][receiver], padded with zeros
        std::array<std::array<float, prt::BlockSize>, 3> channels{};
    };
    /// [num_blocks]
    std::vector<Block> blocks;
    /// [num_blocks] sums over the block's receivers, times prt::FullCount.
    std::vector<WeightSums> whole;

    /// `weights` and `normals` are [num_receivers] by place.
    BlockWeights(std::span<const glm::vec3> weights, std::span<const glm::vec3> normals);
};

/// Which receivers a cluster's light reaches from above: those with n . gate > 0.
struct Gates {
    /// [num_clusters * 9] a vector for each channel: red x y z, green x y z, blue x y z.
    std::vector<float> vectors;
    /// [ceil(num_clusters / 64)] bit c % 64 is set where the channels' vectors differ.
    std::vector<std::uint64_t> differ;
};

/// Sums of weights times normals over the receivers that a cluster reaches, [channel x axis].
struct ClusterWeights {
    /// [num_clusters] of blocks that see the cluster whole, above their horizons: minus those of
    /// the cluster before. Runs of clusters that a block sees so are two entries.
    std::vector<WeightSums> whole_steps;
    /// [num_clusters] of other blocks: counts times weights, of receivers inside the gate.
    std::vector<WeightSums> gated;

    explicit ClusterWeights(std::size_t num_clusters)
        : whole_steps(num_clusters), gated(num_clusters) {}
};

/// Adds all receivers to the clusters of words [first_word, last_word). The bits depend neither on
/// how words are divided among calls, nor on the width of vectors.
void add_receivers(const BlockScene& scene, std::size_t first_word, std::size_t last_word,
                   const Gates& gates, const BlockWeights& weights, ClusterWeights& sums);

} // namespace relumine::relight
