// The clustering behind precompute(): cells of the sphere are tested, then kept as clusters or
// split, until none is left.
// Based on: Johan and Nishita, "Efficient Relighting by Clustering Environment Lights" [JN],
// Section 4.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/clusters/cluster_kernels.h"
#include "prt/clusters/clustering_state.h"
#include "prt/clusters/pending_cells.h"
#include "prt/clusters/visibility_planes.h"
#include "prt/clusters/work_estimate.h"
#include "prt/precompute_context.h"
#include "prt/precompute_options.h"
#include "prt/steps.h"

namespace relumine::prt {

/// Thrown as soon as there will be more than PrecomputeOptions::most_clusters.
struct TooManyClusters : std::exception {};

/// Tests cells in batches: the samples of a batch are traced together, then each cell is decided on
/// its own.
///
/// A batch is a whole level, breadth first, while the planes of a level fit into
/// PrecomputeOptions::plane_bytes. Otherwise a batch is the part of a level that fits, and fine
/// cells come first while little room is left. A cell's fate depends on its nine samples alone, so
/// batches do not change the result.
///
/// Processes that share the work have a part of the receivers each. Batches, steps and decisions
/// follow from figures of all receivers, so they are the same in each process and for any number of
/// processes: which rays are traced together, too.
class Clustering {
public:
    /// The arguments must outlive this object; precompute() has checked them.
    Clustering(const Receivers& receivers, const Blockers& blockers,
               const PrecomputeOptions& options, const Work& work,
               const PrecomputeContext& context);

    /// Does the work; call it once. Leaves the counts of the work in `statistics`.
    [[nodiscard]] Transfer run(PrecomputeStatistics& statistics);

private:
    void start();
    void resume(const Checkpoint::Saved& saved);
    void work();
    void take_batch();
    void start_progress();
    void trace_batch();
    void check_limits(std::span<const std::uint8_t> levels,
                      std::span<const LeafColumn> columns) const;
    void decide_batch();
    [[nodiscard]] Steps::Content content() const;
    void add_cluster(const Cluster& cluster);

    [[nodiscard]] std::vector<LatticePoint> needed_points(const std::vector<Cell>& cells) const;
    [[nodiscard]] std::vector<std::uint8_t> levels_below(std::span<const Cell> cells);
    [[nodiscard]] LeafColumn column(const Cell& cell) const;
    [[nodiscard]] std::uint64_t patches_per_step() const;
    [[nodiscard]] bool is_single_texel(const Cell& cell) const { return cell.level == max_level_; }
    [[nodiscard]] Transfer result();

    const PrecomputeOptions& options_;
    const PrecomputeContext context_;
    const Work& work_;
    std::size_t num_points_;
    /// [num_receivers] all receivers in spatial order, and their normals in that order
    std::vector<std::uint32_t> order_;
    std::vector<glm::vec3> ordered_normals_;
    /// [receivers of this process] starts of their rays, and their normals in arrays
    std::vector<glm::vec3> origins_;
    NormalArrays normals_;
    Progress progress_;
    Steps steps_;
    /// The level whose cells are texels of a 6 x R x R environment.
    std::uint32_t max_level_;
    /// The limit on ||T_C - T_l||^2 for a cluster, T times pi.
    double allowed_;
    std::size_t max_planes_;
    std::uint64_t patches_per_step_ = 1;

    std::optional<VisibilityPlanes> planes_;
    /// The cells in work.
    std::vector<Cell> batch_;
    PendingCells pending_;
    /// The clusters' cells and columns, as they were found.
    std::vector<Cell> clusters_;
    std::optional<ColumnStore> columns_;
    /// For the progress, and what it is to learn from the batch
    WorkEstimate estimate_;
    WorkEstimate::Depths depths_{};
    /// Clusters in the checkpoint.
    std::size_t num_saved_ = 0;
    std::uint64_t column_bytes_ = 0;
    std::size_t most_planes_ = 0;
    /// The deepest level of any cluster.
    std::uint32_t deepest_ = 0;
};

} // namespace relumine::prt
