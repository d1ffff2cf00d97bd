// After a change of the scene, counts of what changed: the rays that no changed triangle can have
// met keep their fate.
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "prt/moves/scene_change.h"
#include "prt/receivers/receivers.h"
#include "prt/transfer/transfer.h"
#include "prt/visibility/blockers.h"
#include "prt/work.h"

namespace relumine::prt {

/// Returns boxes around a mesh's triangles: up to 16, which leave out much of what a single box
/// would hold.
[[nodiscard]] std::vector<mesh::Bounds> boxes_around(const mesh::TriangleMesh& mesh);

/// Which blocks of 16 receivers are counted anew.
enum class Recounted {
    /// As recounted() says
    All,
    /// Those with a receiver that differs, in all clusters
    Differing,
    /// All others
    Still,
    /// The same, where what blocks stands before what the transfer's counts know of: a count is
    /// multiplied with the part that passes.
    Covered
};

struct RecountOptions {
    /// Those of the precompute
    std::uint32_t face_resolution = 1024;
    float bias = 0.0f;
    /// [clusters] true for those that are sampled in their middle alone: for counts that are looked
    /// at for a moment. Empty: none.
    std::vector<bool> coarse = {};
    Recounted blocks = Recounted::All;
};

struct RecountStatistics {
    /// Pairs of blocks and clusters that were counted anew, and those whose counts are others.
    std::uint64_t num_pairs = 0, num_changed = 0;
    std::uint64_t num_rays = 0;
    double seconds = 0.0;
};

/// Returns the counts that are others than those of the transfer, whose clusters, order and number
/// of receivers stay. With them the transfer has the counts that precompute() would find for its
/// clusters, bit by bit, but for coarse ones.
///
/// A block of 16 receivers is counted anew where a ray to one of the cluster's samples may meet one
/// of the boxes, from anywhere in the box around the block. A block with a receiver that differs is
/// counted anew in all clusters.
///
/// Threads: parallel over groups of receivers; the result is the same for any number of threads.
/// Throws:  Cancelled.
[[nodiscard]] CountsPatch recounted(const Receivers& receivers, const Blockers& blockers,
                                    const Transfer& transfer, const SceneDifference& difference,
                                    const RecountOptions& options, const Work& work = {},
                                    RecountStatistics* statistics = nullptr);

} // namespace relumine::prt
