// Which surfaces a receiver sees where it does not see the sky.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <stdexcept>
#include <stop_token>

#include "mesh/triangle_mesh.h"
#include "prt/bounces/bounce_matrix.h"
#include "prt/bounces/bounce_samples.h"
#include "prt/checkpoint.h"
#include "prt/receivers/receivers.h"
#include "prt/team.h"
#include "prt/transfer/transfer.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::prt {

/// What probe lights say of receivers.
struct BounceProbes {
    /// [receivers of the part] ProbeRadiance[0] of each.
    std::span<const float> open_parts;
    /// Of all receivers by place, or of a sample of them.
    std::span<const ProbeRadiance> values;
    /// [num_receivers] by place: which of `values` stands for each receiver. Empty: all are there.
    std::span<const std::uint32_t> index;

    [[nodiscard]] const ProbeRadiance& at(std::uint32_t place) const {
        return values[index.empty() ? place : index[place]];
    }
};

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
    /// Where processes share the work: each has its part of the receivers. Null: this process does
    /// it all. max_bytes is for each.
    Team* reduction = nullptr;
    /// Parts of a plan know nothing of each other: how many rays a receiver needs follows from the
    /// receivers in its own tile.
    bool is_planned = false;
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

/// Traces the rays of a part's receivers, those of options.reduction. join_bounces() makes the
/// matrix of all parts.
///
/// transfer: has the counts of the part's receivers; order and normals are those of all.
/// Result:   the same for any number of processes, and with is_planned for any number of parts.
/// Throws:   as precompute_bounces().
[[nodiscard]] BounceSamples sample_bounces(const mesh::TriangleMesh& mesh,
                                           const Receivers& receivers, const Transfer& transfer,
                                           const BounceProbes& probes, const RayScene& rays,
                                           const BounceOptions& options);

} // namespace relumine::prt
