// Which surfaces a receiver sees where it does not see the sky.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "mesh/triangle_mesh.h"
#include "prt/bounces/bounce_matrix.h"
#include "prt/bounces/bounce_samples.h"
#include "prt/receivers/receivers.h"
#include "prt/transfer/transfer.h"
#include "prt/visibility/ray_scene.h"
#include "prt/work.h"

namespace relumine::prt {

/// What probe lights say of receivers.
struct BounceProbes {
    /// [receivers of the part] ProbeRadiance[0] of each.
    std::span<const float> open_parts;
    /// ProbeRadiance of all receivers by place, or of a sample of them.
    std::span<const ProbeRadiance> values;
    /// [num_receivers] by place: which of `values` stands for each receiver. Empty: all are there.
    /// Otherwise the part knows nothing of others: how many rays a receiver needs follows from the
    /// receivers in its own tile.
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
    std::uint32_t max_directions = MostBounceDirections;
    /// The samples say how many directions each receiver looked into: moves will ask.
    bool is_kept = false;
    /// Backs send the light that their fronts do; otherwise they are black.
    bool two_sided = false;
    /// Lift of the rays' origins, as in PrecomputeOptions.
    float bias = 0.0f;
    /// Rows that take more are refused, as soon as a first look tells: TooLarge is thrown.
    std::uint64_t max_bytes = std::numeric_limits<std::uint64_t>::max();
};

/// Returns BounceOptions::tolerance where nothing is asked for: 0.02, with which pictures of houses
/// are 0.1 of 255 from converged ones. A room has little light but that of bounces, in which their
/// noise would be seen, so it asks for 0.005; its pictures even it out. The noise of vertices that
/// share a pixel evens out, too: the tolerance grows as the root of their number, and the bounces
/// of a fine mesh take no more rays than those of one with 400,000 vertices, or of a room with
/// 25,000.
[[nodiscard]] float automatic_tolerance(std::size_t num_vertices, bool is_room);

/// Memory for each hit of a ray: in its receiver's samples, in the matrix, and in the file that is
/// written.
inline constexpr std::uint64_t BytesPerHit = 12;

/// Finds the emitters of each receiver, a vertex, or a pixel or texel before added vertices:
/// cosine-distributed directions, without those in clusters that it sees whole, are traced to the
/// first surface, and a vertex of the triangle is drawn by its barycentric weight, which is
/// unbiased where the nearest is not. Similar receivers share their samples (similar_receivers.h).
/// A row's sum is the closed part of the hemisphere, exact to the transfer's tolerance: 1 - B under
/// a white sky.
///
/// Where processes share the work, `transfer` has the counts of the process's receivers, and order
/// and normals of all. join_bounces() makes the matrix of all samples.
///
/// Memory:  4 bytes per emitter and per similar receiver, some 100 to 400 bytes per receiver.
/// Threads: parallel over blocks (TBB). A row depends on the receivers around it, not on threads or
///          on the number of processes or parts, nor on a checkpoint that is taken up.
/// Throws:  std::invalid_argument where sizes differ, there are no vertices of the mesh among the
///          receivers, or options are out of range; TooLarge; Cancelled.
[[nodiscard]] BounceSamples sample_bounces(const mesh::TriangleMesh& mesh,
                                           const Receivers& receivers, const Transfer& transfer,
                                           const BounceProbes& probes, const RayScene& rays,
                                           const BounceOptions& options, const Work& work = {});

/// Returns the mean part of all light, seen from the receivers, that ends at other surfaces, from
/// 64 directions and 512 receivers at most.
[[nodiscard]] double estimated_closure(const Receivers& receivers, const Blockers& blockers,
                                       float bias);

} // namespace relumine::prt
