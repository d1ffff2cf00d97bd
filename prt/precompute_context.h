// What stands around a precompute: the trial or the plan that it is a part of.
#pragma once

#include "prt/precompute_options.h"
#include "prt/receivers/receivers.h"
#include "prt/transfer/transfer.h"
#include "prt/visibility/blockers.h"
#include "prt/work.h"

namespace relumine::prt {

struct PrecomputeContext {
    /// For a trial with few receivers: columns count as if there were so many times the receivers.
    double column_scale = 1.0;
    /// Has the order of the receivers; may be null.
    const Transfer* given = nullptr;
    /// The leaves of the given quadtree are the clusters. Nothing is tested.
    bool has_clusters = false;
};

/// Does what the public precompute() does, in a context of the caller's choice.
[[nodiscard]] Transfer precompute(const Receivers& receivers, const Blockers& blockers,
                                  const PrecomputeOptions& options, const Work& work,
                                  const PrecomputeContext& context,
                                  PrecomputeStatistics* statistics = nullptr);

} // namespace relumine::prt
