// The inner loop of lighting receivers with several environments at once. Vectorised with run-time
// dispatch.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "relight/kernels/block_kernels.h"
#include "relight/kernels/kernel_lights.h"

namespace relumine::relight {

/// The light of some environments as the kernel reads it.
///
/// Where all of them light a cluster from the same direction, how much a receiver has of the
/// cluster is the same for all, too: it is computed once, and each environment adds three products.
/// So it is for cells inside of a texel, whatever the texels are. Neighbours inside of one texel
/// have the same colours but for a factor, so that these products are done once for all of them.
struct BatchLights {
    /// Environments that are lit together. More gain little.
    static constexpr std::size_t Most = 16;
    /// Directions and ratios of colours are the same where they differ by no more: a few roundings.
    static constexpr float Roundings = 5e-7f;

    /// One number of each environment.
    struct alignas(64) Numbers {
        std::array<double, Most> of{};
    };

    /// How many of `each` are lit.
    std::size_t size = 0;
    /// [Most]
    std::vector<ClusterLights> each;
    /// [ceil(num_clusters / 64)] bit c % 64 is set where all lights of cluster c have the same
    /// direction.
    std::vector<std::uint64_t> common;
    /// [num_clusters * 3] of those: this direction times a factor.
    std::vector<float> directions;
    /// [num_clusters] of those: the bit of the cluster, at or before this one in its word, whose
    /// colours times the factor are this one's.
    std::vector<std::uint8_t> leaders;
    /// [(padded clusters + 1) * 9] as ClusterLights::prefix.
    std::vector<Numbers> prefix;

    explicit BatchLights(std::size_t num_clusters);
    /// Makes the rest from `each` and `size`.
    void compare_and_sum();
};

/// Lights the blocks of a tile, as light_tile() does with one environment; equal to it but for
/// roundings.
///
/// Shape:   light is [BatchLights::Most][TileBlocks].
void light_tile(const BlockScene& scene, std::size_t tile, const BatchLights& lights,
                std::span<BlockLight> light);

} // namespace relumine::relight
