// The bounces of all receivers in one call.
#pragma once

#include <chrono>
#include <span>
#include <vector>

#include "prt/bounces/bounce_precompute.h"

namespace relumine::prt {

/// Samples the bounces of all receivers and makes the matrix. `probes` is [num_receivers] by place.
inline BounceMatrix precompute_bounces(const mesh::TriangleMesh& mesh, const Receivers& receivers,
                                       const Transfer& transfer,
                                       std::span<const ProbeRadiance> probes, const RayScene& rays,
                                       const BounceOptions& options = {}, const Work& work = {},
                                       BounceStatistics* statistics = nullptr) {
    const auto start = std::chrono::steady_clock::now();
    std::vector<float> open_parts;
    for (const ProbeRadiance& probe : probes)
        open_parts.push_back(probe[0]);
    std::vector<BounceSamples> samples;
    samples.push_back(sample_bounces(mesh, receivers, transfer,
                                     {.open_parts = open_parts, .values = probes, .index = {}},
                                     rays, options, work));
    BounceMatrix result = join_bounces(receivers, transfer, std::move(samples), statistics);
    if (statistics != nullptr)
        statistics->seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
}

} // namespace relumine::prt
