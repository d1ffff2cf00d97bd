// The light of clusters as the kernels of blocks read it, and how it changes.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "relight/kernels/cluster_lights.h"

namespace relumine::relight {

/// Light of the clusters as the kernels read it, over 16 pi.
struct ClusterLights {
    static constexpr std::size_t Stride = 9;
    static constexpr std::size_t DirectionalStride = 6;
    /// [num_clusters * 9] vector irradiance, rounded to float: red x y z, green x y z, blue x y z.
    std::vector<float> vectors;
    /// [num_clusters * 6] the light as if it all came from one direction: x y z, and red, green and
    /// blue. The direction has a length near 1. A receiver has max(n . direction, 0) times the
    /// colour: 10 operations for 16 receivers that see a part of the cluster, where three vectors
    /// take 17.
    std::vector<float> directionals;
    /// [ceil(num_clusters / 64)] bit c % 64 is set where a directional light would be farther from
    /// the cluster's light than DirectionalTolerance of it. This light has a directional light for
    /// each channel, in the direction of the channel's own vector.
    std::vector<std::uint64_t> spread;
    /// [(num_clusters + 1) * 9] sums of `vectors` over the clusters before each one.
    std::vector<double> prefix;

    /// Largest difference of a cluster's vectors and its directional light's, over the vectors'
    /// Frobenius norm.
    static constexpr double DirectionalTolerance = 1.0 / 128;

    explicit ClusterLights(std::size_t num_clusters);
    void set(std::size_t cluster, const VectorIrradiance& irradiance);
    /// Fills `prefix`, which only light_tile() reads.
    void sum_prefix();
    [[nodiscard]] bool is_spread(std::size_t cluster) const {
        return (spread[cluster / 64] >> (cluster % 64) & 1u) != 0;
    }
};

/// The changed clusters among the 64 that share a word of VisibleCounts.
struct ChangedWord {
    /// Index of the cluster / 64.
    std::uint32_t word = 0;
    /// Entries of LightChanges::vectors before the word's first.
    std::uint32_t first = 0;
    /// Bit cluster % 64 is set for each changed cluster.
    std::uint64_t clusters = 0;
    /// Sum of the changes of all vectors.
    std::array<double, ClusterLights::Stride> vector{};

    /// Returns the place of a changed cluster, given its bit, among all of them.
    [[nodiscard]] std::size_t index_of(std::uint64_t cluster) const {
        return first + static_cast<std::size_t>(std::popcount(clusters & (cluster - 1)));
    }
};

/// A directional light that a change adds.
struct DirectionalChange {
    std::array<float, 3> direction{};
    /// Below zero for a directional light that was there before.
    std::array<double, 3> colour{};
};

/// How the light of some clusters changes, clusters ascending.
struct LightChanges {
    std::vector<ChangedWord> words;
    /// [num_changed] new vectors of the clusters minus the old ones.
    std::vector<std::array<double, ClusterLights::Stride>> vectors;
    /// [num_changed + 1] directional lights before each cluster's.
    std::vector<std::uint32_t> directionals_before = {0};
    std::vector<DirectionalChange> directionals;

    void clear();
    /// Sets the light of a cluster, and notes the change if it is one.
    void set(ClusterLights& lights, std::size_t cluster, const VectorIrradiance& irradiance);
};

} // namespace relumine::relight
