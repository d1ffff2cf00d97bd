// What a precompute is asked for, and what it counted.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

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
    /// Where given, the tolerance grows until no more clusters are needed, and the clusters are
    /// chosen from a ReceiverSample: the RMS of a cell is that of the sample.
    std::optional<std::uint32_t> most_clusters = {};
    /// Every cell is split at least this often: nine samples can miss a thin blocker.
    std::uint32_t min_level = 3;
    /// R, 1..16384: cells stop at single texels of a 6 x R x R environment.
    std::uint32_t face_resolution = 1024;
    /// Lift of the rays' origins along the normal, in the mesh's unit; see automatic_bias().
    float bias = 0.0f;
    /// Limit on the planes of visibility in memory, one bit per receiver and direction. About 250
    /// planes are in memory in any case. With a lower limit, directions on borders between batches
    /// of cells are traced more than once. The result is the same. For all processes together.
    std::uint64_t plane_bytes = std::uint64_t{512} << 20;
    /// Limit on the columns of clusters in memory. They are the largest part of it beside the
    /// planes, and joining and writing them takes as much again. Beyond the limit TooLarge is
    /// thrown. For each of the processes that share the work.
    std::uint64_t max_column_bytes = std::numeric_limits<std::uint64_t>::max();
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
    /// Most bytes of the planes of visibility at once
    std::uint64_t plane_bytes = 0;
    std::uint32_t deepest_level = 0;
    /// That the clusters were chosen with, where it grew; else 0
    float grown_tolerance = 0.0f;
    double seconds = 0.0;
    /// The part of `seconds` for checkpoints.
    double seconds_checkpoints = 0.0;
};

} // namespace relumine::prt
