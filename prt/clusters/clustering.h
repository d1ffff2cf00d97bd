// The clustering behind precompute(): cells of the sphere are tested, kept as clusters or split,
// until none is left. Based on: Johan and Nishita, "Efficient Relighting by Clustering Environment
// Lights" [JN], Section 4.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/clusters/cluster_kernels.h"
#include "prt/clusters/clustering_state.h"
#include "prt/clusters/pending_cells.h"
#include "prt/clusters/visibility_planes.h"
#include "prt/precompute.h"
#include "prt/precompute_context.h"
#include "prt/progress.h"

namespace relumine::prt {

/// Cells are tested in batches: their samples are traced together, then each is decided on its own.
/// A batch is a whole level, breadth first, where its planes have room in
/// PrecomputeOptions::plane_bytes; else as much of a level as has, and fine cells come first while
/// little room is left. What becomes of a cell depends on its nine samples alone, so batches do not
/// change the result.
class Clustering {
public:
    /// The arguments must outlive this; checked by precompute().
    Clustering(const Receivers& receivers, const Blockers& blockers,
               const PrecomputeOptions& options, const PrecomputeContext& context);

    /// Once. Leaves the counts of its work in `statistics`.
    [[nodiscard]] Transfer run(PrecomputeStatistics& statistics);

private:
    /// A cell that became a cluster, or (column empty) one that is to be split.
    struct Decision {
        Cell cell;
        std::optional<LeafColumn> column;
    };

    void start();
    void resume(const Checkpoint::Saved& saved);
    void work();
    void take_batch();
    void trace_batch();
    void decide_batch();
    void save_checkpoint();
    void add_cluster(Cluster&& cluster);

    [[nodiscard]] std::vector<LatticePoint> needed_points(const Cell& cell) const;
    [[nodiscard]] std::vector<LatticePoint> needed_points(const std::vector<Cell>& cells) const;
    [[nodiscard]] Decision decide(const Cell& cell) const;
    [[nodiscard]] bool is_single_texel(const Cell& cell) const { return cell.level == max_level_; }
    [[nodiscard]] Transfer result();

    const PrecomputeOptions& options_;
    const PrecomputeContext context_;
    std::vector<std::uint32_t> order_;
    std::vector<glm::vec3> ordered_normals_;
    std::vector<glm::vec3> origins_;
    NormalArrays normals_;
    Progress progress_;
    /// Where a cell is one texel of a 6 x R x R environment
    std::uint32_t max_level_;
    /// The largest ||T_C - T_l||^2, T times pi, of a cluster
    double allowed_;
    std::size_t max_planes_;

    std::optional<VisibilityPlanes> planes_;
    /// In work
    std::vector<Cell> batch_;
    PendingCells pending_;
    std::vector<Cluster> clusters_;
    /// Part of the cube's surface that is clustered
    double settled_ = 0.0;
    /// Clusters in the checkpoint
    std::size_t num_saved_ = 0;
    std::uint64_t column_bytes_ = 0;
    double seconds_saving_ = 0.0;
    /// Level of a cluster
    std::uint32_t deepest_ = 0;
};

} // namespace relumine::prt
