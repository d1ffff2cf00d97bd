// After a change of the scene, counts of what changed: the rays that no changed triangle can have
// met keep their fate.
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "prt/moves/scene_change.h"
#include "prt/precompute_options.h"
#include "prt/receivers/receivers.h"
#include "prt/transfer/transfer.h"
#include "prt/visibility/blockers.h"
#include "prt/work.h"

namespace relumine::prt {

/// Returns boxes around a mesh's triangles: up to 16, which leave out much of what a single box
/// would hold.
[[nodiscard]] std::vector<mesh::Bounds> boxes_around(const mesh::TriangleMesh& mesh);

struct RecountStatistics {
    /// Pairs of blocks and clusters that were counted anew, and those whose counts are others.
    std::uint64_t num_pairs = 0, num_changed = 0;
    std::uint64_t num_rays = 0;
    double seconds = 0.0;
};

/// Returns the counts that are others than those of the transfer, whose clusters, order and number
/// of receivers stay. With them the transfer has the counts that precompute() would find for its
/// clusters, bit by bit.
///
/// A block of 16 receivers is counted anew where a ray to one of the cluster's samples may meet one
/// of the boxes, from anywhere in the box around the block. A block with a receiver that differs is
/// counted anew in all clusters.
///
/// options: those of the precompute; bias and face_resolution count.
/// Threads: parallel over groups of receivers; the result is the same for any number of threads.
/// Throws:  Cancelled.
[[nodiscard]] CountsPatch recounted(const Receivers& receivers, const Blockers& blockers,
                                    const Transfer& transfer, const SceneDifference& difference,
                                    const PrecomputeOptions& options, const Work& work = {},
                                    RecountStatistics* statistics = nullptr);

} // namespace relumine::prt
