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

/// Weights of a block's receivers times their normals, [channel x axis][receiver].
struct alignas(64) BlockWeights {
    static constexpr std::size_t Size = 9;
    std::array<std::array<float, prt::BlockSize>, Size> products{};
    /// [channel x axis] sums over the receivers, times prt::FullCount.
    std::array<double, Size> whole{};
};

/// Returns the weights in blocks.
///
/// Shape:   `weights` and `normals` are [num_receivers] by place; the result is [num_blocks].
[[nodiscard]] std::vector<BlockWeights> block_weights(std::span<const glm::vec3> weights,
                                                      std::span<const glm::vec3> normals);

/// Which receivers a cluster's light reaches from above: those with n . gate > 0.
struct Gates {
    /// [num_clusters * 9] a vector for each channel: red x y z, green x y z, blue x y z.
    std::vector<float> vectors;
    /// [ceil(num_clusters / 64)] bit c % 64 is set where the channels' vectors differ.
    std::vector<std::uint64_t> differ;
};

/// Sums of weights times normals over the receivers that a cluster reaches, [channel x axis].
struct ClusterWeights {
    using Sums = std::array<double, BlockWeights::Size>;
    /// [num_clusters] of blocks that see the cluster whole, above their horizons: minus those of
    /// the cluster before. Runs of clusters that a block sees so are two entries.
    std::vector<Sums> whole_steps;
    /// [num_clusters] of other blocks: counts times weights, of receivers inside the gate.
    std::vector<Sums> gated;

    explicit ClusterWeights(std::size_t num_clusters)
        : whole_steps(num_clusters), gated(num_clusters) {}
};

/// Adds all receivers to the clusters of words [first_word, last_word). The bits depend neither on
/// how words are divided among calls, nor on the width of vectors.
void add_receivers(const BlockScene& scene, std::size_t first_word, std::size_t last_word,
                   const Gates& gates, std::span<const BlockWeights> weights, ClusterWeights& sums);

} // namespace relumine::relight
