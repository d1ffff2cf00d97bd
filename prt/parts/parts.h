// A precompute in parts that know nothing of each other: the clusters are chosen first, from a
// sample of the receivers, and then each part counts for its own receivers.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>

#include "prt/clusters/visible_counts.h"
#include "prt/precompute.h"
#include "prt/receivers/receivers.h"
#include "prt/transfer.h"
#include "prt/visibility/blockers.h"

namespace relumine::prt {

/// The most parts of a precompute.
inline constexpr std::uint32_t MaxParts = 1 << 16;

/// One of several parts. Parts take the tiles of VisibleCounts in turn: neighbouring tiles cost
/// about the same, so the parts do, too.
struct Part {
    /// 0 .. count - 1
    std::uint32_t index = 0;
    std::uint32_t count = 1;

    bool operator==(const Part&) const = default;
};

/// Chooses the clusters as precompute() does, from every n-th block of 16 neighbours: n is 16 for
/// many receivers, less where fewer than 1,024 blocks would remain. Returns a transfer with
/// quadtree, order and normals, whose counts are missing.
///
/// Differs from [JN, Section 4]: the RMS of a cell is that of the sample.
///
/// Cost:    1/n of a precompute.
/// Throws:  as precompute() does.
[[nodiscard]] Transfer plan_clusters(const Receivers& receivers, const Blockers& blockers,
                                     const PrecomputeOptions& options,
                                     PrecomputeStatistics* statistics = nullptr);

/// Counts a part's receivers for the clusters of a plan. The receivers of the result are those of
/// the part's tiles, in their order; it is empty for a part without tiles.
///
/// Options: bias, plane_bytes, max_column_bytes, stop and on_progress. Joined counts are the same
///          bit by bit for any number of parts if bias and plane_bytes are.
/// Memory:  twice the part's result, and its share of plane_bytes.
/// Threads: parallel over receivers (TBB), the same result for any number of threads.
/// Throws:  std::invalid_argument for an index that is not below the count, or more than
///          MaxParts; Cancelled;
///          TooManyClusters.
[[nodiscard]] VisibleCounts part_counts(const Receivers& receivers, const Transfer& plan,
                                        const Blockers& blockers, const PrecomputeOptions& options,
                                        const Part& part,
                                        PrecomputeStatistics* statistics = nullptr);

/// Puts the counts of all parts together.
///
/// parts:   in the order of their indices.
/// Throws:  std::invalid_argument for counts that do not fit the plan.
[[nodiscard]] VisibleCounts joined_counts(const Transfer& plan,
                                          std::span<const VisibleCounts> parts);

} // namespace relumine::prt
