// A precompute in parts that know nothing of each other: the clusters are chosen first, from a
// sample of the receivers, and then each part counts for its own receivers.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "prt/bounces/bounce_samples.h"
#include "prt/glossy/glossy_precompute.h"
#include "prt/precompute.h"
#include "prt/receivers/receivers.h"
#include "prt/team.h"
#include "prt/transfer/transfer.h"
#include "prt/visibility/blockers.h"

namespace relumine::prt {

/// Chooses the clusters as precompute() does, from every n-th block of 16 neighbours: n is 16 for
/// many receivers, less where fewer than 1,024 blocks would remain. Returns a transfer with
/// quadtree, order and normals, whose counts are missing. `of_sample` receives the transfer of the
/// sample, whose receivers are numbered as they come in spatial order.
///
/// Differs from [JN, Section 4]: the RMS of a cell is that of the sample.
///
/// Cost:    1/n of a precompute.
/// Throws:  as precompute() does.
[[nodiscard]] Transfer plan_clusters(const Receivers& receivers, const Blockers& blockers,
                                     const PrecomputeOptions& options,
                                     PrecomputeStatistics* statistics = nullptr,
                                     Transfer* of_sample = nullptr);

/// Returns which receiver of the sample stands for each receiver: of the sampled block next to it
/// in spatial order, the one that faces most alike.
///
/// Shape:   [num_receivers] by place.
[[nodiscard]] std::vector<std::uint32_t> sampled_receivers(const Transfer& plan);

/// Returns how many receivers the sample of so many has.
[[nodiscard]] std::size_t num_sampled_receivers(std::size_t num_receivers);

/// Counts a part's receivers for the clusters of a plan. The receivers of the result are those of
/// the part's tiles, in their order; it is empty for a part without tiles.
///
/// Options: those that the plan was made with. Joined counts are the same bit by bit for any number
///          of parts.
/// Memory:  the part's result, and its share of plane_bytes or of 2,048 planes of visibility,
///          whichever is more.
/// Throws:  std::invalid_argument for an index that is not below the count, or more than
///          MaxParts; as precompute() does.
[[nodiscard]] VisibleCounts part_counts(const Receivers& receivers, const Transfer& plan,
                                        const Blockers& blockers, const PrecomputeOptions& options,
                                        const Part& part,
                                        PrecomputeStatistics* statistics = nullptr);

/// Computes the highlights of a part's receivers, as precompute_glossy() does for all. `shared` has
/// the counts of the part, and the order and the normals of all receivers. Afterwards it is as
/// before.
///
/// Throws:  as precompute_glossy() does; `shared` has no counts then.
[[nodiscard]] GlossyTransfer part_highlights(const Receivers& receivers, Transfer& shared,
                                             const Blockers& blockers, const GlossyOptions& options,
                                             const Part& part,
                                             GlossyStatistics* statistics = nullptr);

/// What a part computes.
struct PartLight {
    VisibleCounts counts;
    /// Only where there are highlights
    std::optional<GlossyTransfer> glossy = {};
    /// Only where light bounces
    std::optional<BounceSamples> bounces = {};
};

/// Gives a plan the counts and highlights of all parts; set_surfaces() then completes it.
///
/// parts:   in the order of their indices.
/// Throws:  std::invalid_argument for parts that do not fit the plan.
void join_light(Transfer& plan, std::span<const PartLight> parts);

/// Makes the matrix of the bounces of all parts; none where light does not bounce. `plan` has order
/// and normals. Frees what the parts have.
///
/// Throws:  as join_light().
[[nodiscard]] std::optional<BounceMatrix> join_bounces_of(const Receivers& receivers,
                                                          const Transfer& plan,
                                                          std::span<PartLight> parts,
                                                          BounceStatistics* statistics = nullptr);

} // namespace relumine::prt
