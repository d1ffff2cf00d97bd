// What a precompute is asked for, what it counted, and how it may end early.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <stop_token>

#include "prt/checkpoint.h"
#include "prt/team.h"

namespace relumine::prt {

struct PrecomputeOptions {
    /// The limit below which a cell becomes a cluster, 1/sr, albedo 1: the RMS over the receivers
    /// of T_C - T_l, ||T_C - T_l|| / sqrt(N), for all samples l. The default is the paper's epsilon
    /// of 5e-5 for its Bunny of 73,196 vertices. 0 splits everything down to single texels.
    ///
    /// Differs from [JN, Eq. 11], which divides by N and so gets worse for big meshes. `epsilon` is
    /// the paper's form.
    float tolerance = 0.0135f;
    /// The paper's form [JN, Eq. 11]: ||T_C - T_l|| / N < epsilon. Overrides tolerance.
    std::optional<float> epsilon = {};
    /// Every cell is split at least this often: nine samples can miss a thin blocker.
    std::uint32_t min_level = 3;
    /// R, 1..16384: cells stop at single texels of a 6 x R x R environment.
    std::uint32_t face_resolution = 1024;
    /// Lift of the rays' origins along the normal, in the mesh's unit; see automatic_bias().
    float bias = 0.0f;
    /// Limit on the planes of visibility in memory, one bit per receiver and direction. About 250
    /// planes are in memory in any case. With a lower limit, directions on borders between batches
    /// of cells are traced more than once. The result is the same.
    std::uint64_t plane_bytes = std::uint64_t{512} << 20;
    /// Limit on the columns of clusters in memory. They are the largest part of it beside the
    /// planes, and joining and writing them takes as much again. Beyond the limit TooManyClusters
    /// is thrown.
    std::uint64_t max_column_bytes = std::numeric_limits<std::uint64_t>::max();
    /// Where processes share the work: each has its part of the receivers, and what they decide
    /// follows from figures of all. Null: this process does it all. `plane_bytes` is then for all
    /// processes together, max_column_bytes for each; `stop` ends all when one is asked to.
    Team* reduction = nullptr;
    /// Stores the work now and then, and gives back the work of an earlier run; may be null. Where
    /// the receivers have highlights, a last checkpoint is left for precompute_glossy(), which
    /// follows.
    Checkpoint* checkpoint = nullptr;
    /// Polled a few times a second or more often.
    std::stop_token stop = {};
    /// Receives an estimate of the fraction done, in [0, 1], which never falls; one call at a time.
    std::function<void(double)> on_progress = {};
};

struct PrecomputeStatistics {
    std::uint64_t num_clusters = 0;
    /// Sample directions traced. Each counts once unless plane_bytes were too few.
    std::uint64_t num_directions = 0;
    /// (receiver, direction) pairs decided: receivers times directions.
    std::uint64_t num_samples = 0;
    /// Samples above the receiver's horizon, which were traced.
    std::uint64_t num_rays = 0;
    /// The rays of this process.
    std::uint64_t num_own_rays = 0;
    /// Bytes of all clusters' columns before they were joined, of this process.
    std::uint64_t column_bytes = 0;
    /// Of the planes of visibility, at most at once
    std::uint64_t plane_bytes = 0;
    std::uint32_t deepest_level = 0;
    double seconds = 0.0;
    /// The part of `seconds` for checkpoints.
    double seconds_checkpoints = 0.0;
};

/// Thrown by precompute() when its stop token asks for it.
struct Cancelled : std::exception {
    [[nodiscard]] const char* what() const noexcept override { return "cancelled"; }
};

/// Thrown by precompute() when the clusters take more than max_column_bytes, or would in the end.
/// It leaves a checkpoint.
struct TooManyClusters : std::runtime_error {
    TooManyClusters(std::uint64_t clusters, std::uint64_t bytes);
    /// A lower bound.
    std::uint64_t num_clusters;
    /// A lower bound on these clusters' bytes.
    std::uint64_t column_bytes;
};

} // namespace relumine::prt
