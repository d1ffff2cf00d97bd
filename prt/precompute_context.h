// What stands around a precompute: the trial, the longer run or the test that it is a part of.
#pragma once

#include <cstdint>
#include <optional>

#include "prt/precompute_options.h"
#include "prt/receivers/receivers.h"
#include "prt/transfer/transfer.h"
#include "prt/visibility/blockers.h"

namespace relumine::prt {

struct PrecomputeContext {
    /// For a trial with few receivers: columns count as if there were so many times the receivers.
    double column_scale = 1.0;
    /// Other work follows: a last checkpoint is left when the clusters are done.
    bool more_follows = false;
    /// Order and quadtree are given: cells are split down to its leaves and not tested. May be
    /// null.
    const Transfer* plan = nullptr;
    /// For tests: work between two looks at the checkpoint, in samples.
    std::optional<std::uint64_t> samples_per_step = {};
};

/// Does what the public precompute() does, in a context of the caller's choice.
[[nodiscard]] Transfer precompute(const Receivers& receivers, const Blockers& blockers,
                                  const PrecomputeOptions& options,
                                  const PrecomputeContext& context,
                                  PrecomputeStatistics* statistics = nullptr);

} // namespace relumine::prt
