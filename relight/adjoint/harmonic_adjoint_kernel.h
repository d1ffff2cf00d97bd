// The inner loop of the adjoint of harmonics: the walk of light_harmonics(), backwards. Receivers'
// weights are summed into clusters. Vectorised with run-time dispatch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/receivers/block_size.h"
#include "relight/harmonics/cluster_harmonics.h"
#include "relight/kernels/block_kernels.h"

namespace relumine::relight {

/// Weights of coefficients, in blocks of receivers.
struct HarmonicWeights {
    /// Numbers of a receiver: three channels of the order's coefficients.
    std::size_t stride;
    /// [num_blocks * stride * 16] [block][channel][coefficient][receiver], padded with zeros.
    std::vector<float> lanes;
    /// [num_blocks * stride] sums over the block's receivers, times prt::FullCount.
    std::vector<double> whole;

    /// `weights` is [num_receivers][order^2] in the receivers' own order, `order_of` by place.
    HarmonicWeights(std::span<const glm::vec3> weights, std::span<const std::uint32_t> order_of);
};

/// The derivative of a number by what ClusterHarmonics keeps of each cluster.
struct HarmonicSums {
    /// [num_clusters * stride] by the coefficients, of blocks that see the cluster whole: minus
    /// those of the cluster before.
    std::vector<double> whole_steps;
    /// [num_clusters * 3] by the flux, where the group's basis functions stay as they are.
    std::vector<double> fluxes;
    /// [num_slots * stride] by the group's basis functions. A slot is the part of a group in one
    /// word of clusters, so that a slot has one writer.
    std::vector<double> bases;
    /// [num_words + 1] the word's first slot; a word has a slot for each of its groups.
    std::vector<std::size_t> first_slot;

    explicit HarmonicSums(const ClusterHarmonics& lights);
};

/// Adds all receivers to the clusters of words [first_word, last_word). The bits do not depend on
/// how words are divided among calls.
void add_receivers(const BlockScene& scene, std::size_t first_word, std::size_t last_word,
                   const ClusterHarmonics& lights, const HarmonicWeights& weights,
                   HarmonicSums& sums);

} // namespace relumine::relight
