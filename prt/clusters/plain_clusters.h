// The clustering as [JN, Section 4] has it, to be read first: what precompute() finds with batches,
// bits and threads, and is held to.
// Based on: Johan and Nishita, "Efficient Relighting by Clustering Environment Lights" [JN].
#pragma once

#include <cstdint>
#include <vector>

#include "prt/precompute_options.h"
#include "prt/receivers/receivers.h"
#include "prt/transfer/quadtree.h"
#include "prt/visibility/blockers.h"

namespace relumine::prt {

/// Light clusters, and how much of each the receivers see.
struct PlainClusters {
    Quadtree quadtree;
    /// [leaf][receiver] 16 times the visible part of what is above the receiver's horizon, rounded;
    /// 0 where nothing is above.
    std::vector<std::vector<std::uint8_t>> counts;
};

/// Splits cells of the sphere while one of their nine samples is too far from the mean of all nine.
///
/// Cost:    nine rays for each cell and receiver, on one thread.
[[nodiscard]] PlainClusters plain_clusters(const Receivers& receivers, const Blockers& blockers,
                                           const PrecomputeOptions& options);

} // namespace relumine::prt
