// The state of the clustering as bytes for a checkpoint. Everything else follows from the
// receivers, blockers and options.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "prt/clusters/column_store.h"
#include "prt/clusters/pending_cells.h"
#include "prt/clusters/visibility_planes.h"
#include "prt/transfer/quadtree.h"

namespace relumine::prt {

/// A finished cluster.
struct Cluster {
    Cell cell;
    LeafColumn column;
};

/// Packs the clusters from `first` on into one record.
[[nodiscard]] std::vector<std::byte> clusters_record(std::span<const Cell> cells,
                                                     const ColumnStore& columns, std::size_t first);
/// Appends the clusters of a record. Their columns have the tiles that the record has.
///
/// Throws:  std::runtime_error for bytes that are no such record.
void read_clusters(std::span<const std::byte> record, std::vector<Cluster>& clusters);

/// Packs the remaining work: cells being tested, cells waiting, and the known planes.
[[nodiscard]] std::vector<std::byte> work_state(const std::vector<Cell>& batch,
                                                const PendingCells& pending,
                                                const VisibilityPlanes& planes);
/// Unpacks work_state() into an empty batch, empty queues and new planes.
///
/// Throws:  std::runtime_error for bytes that are no such state.
void read_work(std::span<const std::byte> state, std::vector<Cell>& batch, PendingCells& pending,
               VisibilityPlanes& planes);

} // namespace relumine::prt
