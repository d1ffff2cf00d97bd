// Which surfaces a receiver sees where it does not see the sky.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <stdexcept>
#include <stop_token>

#include "mesh/triangle_mesh.h"
#include "prt/bounces/bounce_matrix.h"
#include "prt/checkpoint.h"
#include "prt/receivers/receivers.h"
#include "prt/transfer.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::prt {

/// Lights that decide how many rays a receiver needs: a white sky, then suns along +X, -X, +Y, -Y,
/// +Z and -Z.
inline constexpr std::size_t NumProbeLights = 7;

/// Direct radiance of a receiver of albedo 1 under each probe light. The sky has radiance 1, so the
/// first value is the open part of the hemisphere. A sun has irradiance pi on a surface that faces
/// it.
using ProbeRadiance = std::array<float, NumProbeLights>;

struct BounceOptions {
    /// The limit of the standard error of one bounce under any probe light, as a radiance, for
    /// albedo 1. The samples of 16 neighbours tell how large it is.
    float tolerance = 0.01f;
    /// Directions that each receiver looks into at first. They are doubled as often as the
    /// tolerance asks for.
    std::uint32_t min_directions = 48;
    /// A power of two times min_directions at which the doubling ends.
    std::uint32_t max_directions = 3072;
    /// Backs send the light that their fronts do; otherwise they are black.
    bool two_sided = false;
    /// Lift of the rays' origins, as in PrecomputeOptions.
    float bias = 0.0f;
    /// Rows that take more are refused, as soon as a first look tells.
    std::uint64_t max_bytes = std::numeric_limits<std::uint64_t>::max();
    /// Gets the finished blocks now and then, and gives back those of an earlier run. May be null.
    Checkpoint* checkpoint = nullptr;
    /// Polled a few times a second or more often.
    std::stop_token stop = {};
    /// Receives the fraction done in [0, 1]; one call at a time.
    std::function<void(double)> on_progress = {};
};

/// Memory for each hit of a ray: in its receiver's samples, in the matrix, and in the file that is
/// written.
inline constexpr std::uint64_t BytesPerHit = 12;

/// Thrown by precompute_bounces() when the rows would take more than max_bytes.
struct TooManyHits : std::runtime_error {
    explicit TooManyHits(std::uint64_t hits);
    std::uint64_t num_hits;
};

struct BounceStatistics {
    std::uint64_t num_rays = 0;
    std::uint64_t num_hits = 0;
    /// Hits on surfaces that face the ray.
    std::uint64_t num_emitters = 0;
    /// Mean number of receivers that share their samples.
    double mean_averaged = 0.0;
    /// Of all receivers: the part of the hemisphere that surfaces close.
    double mean_closure = 0.0;
    /// Estimated standard error of one bounce, RMS over all receivers, worst of the probe lights.
    double rms_error = 0.0;
    double seconds = 0.0;
};

/// Finds the emitters of each receiver, a vertex, or a pixel or texel before added vertices:
/// cosine-distributed directions, without those in clusters that it sees whole, are traced to the
/// first surface, and a vertex of the triangle is drawn by its barycentric weight, which is
/// unbiased where the nearest is not. Similar receivers share their samples (similar_receivers.h).
/// A row's sum is the closed part of the hemisphere, exact to the transfer's tolerance: 1 - B under
/// a white sky.
///
/// Shape:   `probes` is [num_receivers] by place.
/// Memory:  4 bytes per emitter and per similar receiver, some 100 to 400 bytes per receiver.
/// Threads: parallel over blocks (TBB). A row depends on the receivers around it, not on threads,
///          nor on a checkpoint that is taken up.
/// Throws:  std::invalid_argument where sizes differ, there are no vertices of the mesh among the
///          receivers, or options are out of range; TooManyHits; Cancelled.
[[nodiscard]] BounceMatrix precompute_bounces(const mesh::TriangleMesh& mesh,
                                              const Receivers& receivers, const Transfer& transfer,
                                              std::span<const ProbeRadiance> probes,
                                              const RayScene& rays, const BounceOptions& options,
                                              BounceStatistics* statistics = nullptr);

} // namespace relumine::prt
