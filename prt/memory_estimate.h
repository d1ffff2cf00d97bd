// How much memory a precompute will take.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "prt/precompute.h"
#include "prt/receivers/receivers.h"
#include "prt/visibility/blockers.h"

namespace relumine::prt {

/// What is known of a precompute before it begins.
struct SceneSizes {
    std::size_t num_vertices = 0;
    std::size_t num_triangles = 0;
    std::size_t num_receivers = 0;
    /// A BeamScene beside the RayScene
    bool has_beams = true;
};

/// Bytes of the mesh, its receivers and what answers for its triangles: there while the clustering
/// runs.
[[nodiscard]] std::uint64_t scene_bytes(const SceneSizes& sizes);

/// The largest number of bytes in use when the clusters' columns take `column_bytes` (see
/// Clustering) and planes `plane_bytes`: while tracing, while the columns are joined, or while the
/// scene is written.
[[nodiscard]] std::uint64_t peak_bytes(const SceneSizes& sizes, std::uint64_t plane_bytes,
                                       std::uint64_t column_bytes);

/// The other way round: the largest column_bytes for which peak_bytes() is at most `max_bytes`; 0
/// where there are none.
[[nodiscard]] std::uint64_t max_column_bytes(const SceneSizes& sizes, std::uint64_t plane_bytes,
                                             std::uint64_t max_bytes);

/// The same for the highlights' part, which comes after the columns are joined: the largest
/// GlossyOptions::max_bytes that keeps within `max_bytes` while blocks are refined, joined and
/// written. 0 where there is none.
[[nodiscard]] std::uint64_t max_glossy_bytes(const SceneSizes& sizes, std::uint64_t column_bytes,
                                             std::uint64_t max_bytes);

/// Planes that a limit leaves room for: a quarter of what the scene leaves, no more than the
/// default, no less than 16 MB.
[[nodiscard]] std::uint64_t plane_bytes_within(const SceneSizes& sizes, std::uint64_t max_bytes);

struct MemoryEstimate {
    std::uint64_t num_clusters = 0;
    std::uint64_t plane_bytes = 0;
    std::uint64_t column_bytes = 0;
    std::uint64_t peak_bytes = 0;
    /// The trial was stopped: more than this
    bool is_at_least = false;
};

/// From a trial with some thousand receivers, in groups of neighbours from all over the scene: the
/// tolerance is an RMS, so they take about as many clusters as all. Stops when `max_bytes` are not
/// enough. `options` are those of the run, plane_bytes among them; stop is heeded.
[[nodiscard]] MemoryEstimate estimate_memory(const SceneSizes& sizes, const Receivers& receivers,
                                             const Blockers& blockers,
                                             const PrecomputeOptions& options,
                                             std::uint64_t max_bytes);

} // namespace relumine::prt
