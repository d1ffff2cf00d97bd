// What stands around a precompute: the trial, the longer run or the test that it is a part of.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "prt/glossy/glossy_precompute.h"
#include "prt/precompute.h"

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

/// Does what precompute_glossy() does, and looks at the checkpoint after every `blocks_per_step`
/// blocks. For tests.
[[nodiscard]] GlossyTransfer precompute_glossy_in_steps(const Receivers& receivers,
                                                        const Blockers& blockers,
                                                        const Transfer& transfer,
                                                        const GlossyOptions& options,
                                                        std::size_t blocks_per_step);

} // namespace relumine::prt
