// Fewer clusters for a scene that is there already: siblings are joined without a ray.
// Based on: Johan and Nishita, "Efficient Relighting by Clustering Environment Lights" [JN],
// Section 4.
#pragma once

#include <cstdint>

#include "prt/transfer/transfer.h"
#include "prt/work.h"

namespace relumine::prt {

struct CoarsenOptions {
    /// RMS error of T allowed within a cluster, 1/sr (PrecomputeOptions::tolerance). No smaller
    /// than what the transfer was made with.
    float tolerance = 0.03f;
    /// No cluster gets larger than this level. The precompute's.
    std::uint32_t min_level = 3;
    /// R: cells of the finest level, single texels, have one sample. The precompute's.
    std::uint32_t face_resolution = 1024;
};

/// Returns the transfer with the clusters that a precompute of this tolerance would have had, as
/// far as the stored counts tell.
///
/// The test of a cell is the precompute's, in the mean: a sample is lit with the probability that
/// the counts of the clusters around it say (prt/clusters/shadow_edges.h). The mean of some
/// thousand receivers is what the precompute finds; with few receivers more cells pass than there.
/// The count of a joined cluster is the mean of its clusters' counts, weighted by what each has
/// above the receiver's horizon.
///
/// Highlights, surfaces, normals and the order of receivers stay as they are.
/// Throws:  std::invalid_argument for a tolerance that is not a number above 0; Cancelled.
/// Cost:    O(receivers times clusters); no rays.
/// Threads: parallel inside; the result is the same bit by bit for any number of threads.
[[nodiscard]] Transfer coarsened(const Transfer& transfer, const CoarsenOptions& options,
                                 const Work& work = {});

} // namespace relumine::prt
