// How much memory a precompute will take.
#pragma once

#include <cstddef>
#include <cstdint>

#include "prt/precompute.h"
#include "prt/receivers/receivers.h"
#include "prt/visibility/blockers.h"

namespace relumine::prt {

/// The sizes of a precompute, known before it begins.
struct SceneSizes {
    std::size_t num_vertices = 0;
    std::size_t num_triangles = 0;
    std::size_t num_receivers = 0;
    /// Whether there is a BeamScene beside the RayScene.
    bool has_beams = true;
};

/// Returns the bytes of the mesh, of its receivers and of the structures that answer ray queries.
/// They are in use while the clustering runs.
[[nodiscard]] std::uint64_t scene_bytes(const SceneSizes& sizes);

/// Returns the largest number of bytes in use during tracing, joining the columns and writing the
/// scene. `column_bytes` is the size of all clusters' columns (see Clustering), `plane_bytes` the
/// size of the planes.
[[nodiscard]] std::uint64_t peak_bytes(const SceneSizes& sizes, std::uint64_t plane_bytes,
                                       std::uint64_t column_bytes);

/// Returns the largest column_bytes for which peak_bytes() is at most `max_bytes`; 0 where there is
/// none.
[[nodiscard]] std::uint64_t max_column_bytes(const SceneSizes& sizes, std::uint64_t plane_bytes,
                                             std::uint64_t max_bytes);

/// Returns the largest GlossyOptions::max_bytes for which the highlights' part stays within
/// `max_bytes`, while its blocks are refined, joined and written; 0 where there is none. The part
/// comes after the columns are joined.
[[nodiscard]] std::uint64_t max_glossy_bytes(const SceneSizes& sizes, std::uint64_t column_bytes,
                                             std::uint64_t max_bytes);

/// Returns the largest BounceOptions::max_bytes for which the bounces' part stays within
/// `max_bytes`; 0 where there is none. Bounces come after the highlights.
[[nodiscard]] std::uint64_t max_bounce_bytes(const SceneSizes& sizes, std::uint64_t column_bytes,
                                             std::uint64_t max_bytes);

/// Returns the plane_bytes to use under a limit: a quarter of what the scene leaves, at most the
/// default, at least 16 MiB.
[[nodiscard]] std::uint64_t plane_bytes_within(const SceneSizes& sizes, std::uint64_t max_bytes);

struct MemoryEstimate {
    std::uint64_t num_clusters = 0;
    std::uint64_t plane_bytes = 0;
    std::uint64_t column_bytes = 0;
    std::uint64_t peak_bytes = 0;
    /// The trial stopped early: the numbers are lower bounds.
    bool is_at_least = false;
};

/// Estimates memory from a trial with a few thousand receivers, in groups of neighbours from all
/// over the scene. The tolerance is an RMS, so the trial takes about as many clusters as the whole.
/// The trial stops when `max_bytes` are not enough.
///
/// `options` are the options of the run, plane_bytes among them.
///
/// Throws:  as precompute(), except TooLarge.
[[nodiscard]] MemoryEstimate estimate_memory(const SceneSizes& sizes, const Receivers& receivers,
                                             const Blockers& blockers,
                                             const PrecomputeOptions& options,
                                             std::uint64_t max_bytes,
                                             const std::stop_token& stop = {});

} // namespace relumine::prt
