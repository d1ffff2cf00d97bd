// Receivers whose bounced light is so much alike that they may share their samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "prt/bounces/bounce_matrix.h"

namespace relumine::prt {

struct SimilarityLimits {
    /// The largest error of irradiance as Ward estimates it: distance over the harmonic mean
    /// distance of surfaces, plus sqrt(1 - n.n') [Ward, Rubinstein and Clear 1988, "A Ray Tracing
    /// Solution for Diffuse Interreflection"].
    float max_error = 0.2f;
    /// Members of a list, the receiver itself among them: the nearest.
    std::size_t max_size = 32;
};

/// Lists that are about those that are to be found, which make that quicker.
struct SimilarBefore {
    const PlaceLists* lists = nullptr;
    /// Place in these lists of the first receiver
    std::size_t first = 0;
};

/// Returns for each receiver those that are similar to it, itself among them. The relation is
/// symmetric but for the limit of sizes. Surfaces that are near separate receivers: at contacts and
/// in corners each has its own samples.
///
/// Shape:   all arrays are [num_receivers] by place; `distances` are the harmonic means of the
///          distances of surfaces over the hemisphere, infinite where there are none and 0 where
///          a receiver is to stay alone; `wanted` are the places whose lists are returned.
/// Cost:    O(n log n). Parallel (TBB), the same lists on any number of threads.
[[nodiscard]] PlaceLists
similar_receivers(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                  std::span<const float> distances, const SimilarityLimits& limits,
                  std::span<const std::uint32_t> wanted, const SimilarBefore& before = {});

/// Returns the lists of all receivers.
[[nodiscard]] PlaceLists similar_receivers(std::span<const glm::vec3> positions,
                                           std::span<const glm::vec3> normals,
                                           std::span<const float> distances,
                                           const SimilarityLimits& limits = {});

} // namespace relumine::prt
