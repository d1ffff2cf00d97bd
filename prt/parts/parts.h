// A precompute in parts that know nothing of each other: the clusters are chosen first, from a
// sample of the receivers, and then each part counts for its own receivers.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "prt/bounces/bounce_samples.h"
#include "prt/precompute.h"
#include "prt/receivers/receivers.h"
#include "prt/scene/scene_file.h"
#include "prt/team.h"
#include "prt/transfer/glossy_transfer.h"
#include "prt/transfer/transfer.h"
#include "prt/transfer/visible_counts.h"
#include "prt/visibility/blockers.h"

namespace relumine::prt {

/// Chooses the clusters as precompute() does, from a ReceiverSample. Returns a transfer with
/// quadtree, order and normals, whose counts are missing. `of_sample` receives the transfer of the
/// sample, whose receivers are numbered as they come in spatial order.
///
/// Differs from [JN, Section 4]: the RMS of a cell is that of the sample.
///
/// Cost:    1/n of a precompute.
/// Throws:  as precompute() does.
[[nodiscard]] Transfer plan_clusters(const Receivers& receivers, const Blockers& blockers,
                                     const PrecomputeOptions& options, const Work& work = {},
                                     PrecomputeStatistics* statistics = nullptr,
                                     Transfer* of_sample = nullptr);

/// Returns which receiver of the sample stands for each receiver: of the sampled block next to it
/// in spatial order, the one that faces most alike.
///
/// Shape:   [num_receivers] by place.
[[nodiscard]] std::vector<std::uint32_t> sampled_receivers(const Transfer& plan);

/// Returns how many receivers the sample of so many has.
[[nodiscard]] std::size_t num_sampled_receivers(std::size_t num_receivers);

/// Counts a part's receivers for the clusters of a plan: those of work.team.part(), in their order.
/// The result is empty for a part without tiles.
///
/// Options: those that the plan was made with. Joined counts are the same bit by bit for any number
///          of parts.
/// Memory:  the part's result, and its share of plane_bytes or of 2,048 planes of visibility,
///          whichever is more.
/// Throws:  std::invalid_argument for an index that is not below the count, or more than
///          MaxParts; as precompute() does.
[[nodiscard]] VisibleCounts part_counts(const Receivers& receivers, const Transfer& plan,
                                        const Blockers& blockers, const PrecomputeOptions& options,
                                        const Work& work,
                                        PrecomputeStatistics* statistics = nullptr);

/// What a part computes.
struct PartLight {
    VisibleCounts counts;
    /// Only where there are highlights
    std::optional<GlossyTransfer> glossy = {};
    /// Only where light bounces
    std::optional<BounceSamples> bounces = {};
};

/// Does what join_light() does, but for the counts.
void join_highlights_and_bounces(Scene& scene, std::span<PartLight> parts,
                                 BounceStatistics* statistics = nullptr);

/// Gives a scene without light the counts, highlights and bounces of all parts. Frees what the
/// parts have.
///
/// parts:   in the order of their indices.
/// Throws:  std::invalid_argument for parts that do not fit the scene.
void join_light(Scene& scene, std::span<PartLight> parts, BounceStatistics* statistics = nullptr);

} // namespace relumine::prt
