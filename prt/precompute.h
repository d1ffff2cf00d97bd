// The preprocessor: from receivers and blockers to light clusters and their transfer.
#pragma once

#include "prt/precompute_options.h"
#include "prt/receivers/receivers.h"
#include "prt/transfer/transfer.h"
#include "prt/visibility/blockers.h"
#include "prt/work.h"

namespace relumine::prt {

/// Clusters all directions of the sphere by their light transfer to the receivers [JN, Section 4].
/// Each sample direction is traced once for each receiver, where plane_bytes allow it.
///
/// Where processes share the work, each gets the same quadtree, order and normals, and the counts
/// of its own receivers.
///
/// Memory:  twice the result, and plane_bytes.
/// Threads: parallel over receivers (TBB). The result is the same bit by bit for any number of
///          threads, with or without a checkpoint taken up.
/// Throws:  std::invalid_argument for options out of range or no receivers; Cancelled when stopped;
///          TooLarge.
[[nodiscard]] Transfer precompute(const Receivers& receivers, const Blockers& blockers,
                                  const PrecomputeOptions& options = {}, const Work& work = {},
                                  PrecomputeStatistics* statistics = nullptr);

} // namespace relumine::prt
