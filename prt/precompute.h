// The preprocessor: from receivers and blockers to light clusters and their transfer.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <stop_token>

#include "prt/checkpoint.h"
#include "prt/receivers/receivers.h"
#include "prt/transfer.h"
#include "prt/visibility/blockers.h"

namespace relumine::prt {

struct PrecomputeOptions {
    /// A cell is a cluster when the RMS over the receivers of T_C - T_l is below this for all
    /// samples l, 1/sr, albedo 1:
    /// ||T_C - T_l|| / sqrt(N) < tolerance. The default is the paper's epsilon of 5e-5 for its
    /// Bunny of 73,196 vertices. 0 splits everything down to single texels. Differs from [JN, Eq.
    /// 11], which divides by N, so that big meshes get worse; `epsilon` is that form.
    float tolerance = 0.0135f;
    /// [JN, Eq. 11]: ||T_C - T_l|| / N < epsilon; overrides tolerance
    std::optional<float> epsilon = {};
    /// Every cell is split at least this often: nine samples can miss a thin blocker
    std::uint32_t min_level = 3;
    /// R, 1..16384: cells stop at single texels of a 6 x R x R environment
    std::uint32_t face_resolution = 1024;
    /// Lift of the rays' origins along the normal, in the mesh's unit; see automatic_bias()
    float bias = 0.0f;
    /// Planes of visibility that may live at once, one bit per receiver and direction. With less,
    /// directions on borders between batches of cells are traced more than once; the result is the
    /// same. About 250 planes live in any case.
    std::uint64_t plane_bytes = std::uint64_t{512} << 20;
    /// Columns of clusters that may be in memory, the largest part of it next to the planes;
    /// joining and writing them takes as much again. Beyond it TooManyClusters is thrown.
    std::uint64_t max_column_bytes = std::numeric_limits<std::uint64_t>::max();
    /// Where the work is left now and then, and taken up. Where the receivers have highlights,
    /// precompute_glossy() follows, and a last checkpoint is left for it.
    Checkpoint* checkpoint = nullptr;
    /// Polled a few times a second or more often
    std::stop_token stop = {};
    /// Estimated fraction in [0, 1], never falling; one call at a time
    std::function<void(double)> on_progress = {};
};

struct PrecomputeStatistics {
    std::uint64_t num_clusters = 0;
    /// Sample directions traced; each once unless plane_bytes were few
    std::uint64_t num_directions = 0;
    /// (receiver, direction) pairs decided: receivers times directions
    std::uint64_t num_samples = 0;
    /// Those above the receiver's horizon, which were traced
    std::uint64_t num_rays = 0;
    /// Of all clusters' columns before they were joined
    std::uint64_t column_bytes = 0;
    std::uint32_t deepest_level = 0;
    double seconds = 0.0;
    /// Of these
    double seconds_checkpoints = 0.0;
};

/// Thrown by precompute() when its stop token asks.
struct Cancelled : std::exception {
    [[nodiscard]] const char* what() const noexcept override { return "cancelled"; }
};

/// Thrown by precompute() when the clusters take more than max_column_bytes, or must in the end; a
/// checkpoint is left.
struct TooManyClusters : std::runtime_error {
    TooManyClusters(std::uint64_t clusters, std::uint64_t bytes);
    /// At least
    std::uint64_t num_clusters;
    /// Theirs, at least
    std::uint64_t column_bytes;
};

/// Clusters all directions of the sphere by their light transfer to the receivers [JN, Section 4].
/// Each sample direction is traced once for each receiver, where plane_bytes allow. Parallel over
/// receivers (TBB); the result is the same bit by bit for any number of threads, and whether or not
/// it was taken up from a checkpoint. Memory: the result twice, and plane_bytes. Throws
/// std::invalid_argument for options out of range or no receivers, Cancelled when stopped,
/// TooManyClusters.
[[nodiscard]] Transfer precompute(const Receivers& receivers, const Blockers& blockers,
                                  const PrecomputeOptions& options = {},
                                  PrecomputeStatistics* statistics = nullptr);

} // namespace relumine::prt
