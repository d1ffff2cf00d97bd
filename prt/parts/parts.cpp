#include "prt/parts/parts.h"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "files/parallel.h"
#include "prt/clusters/dealt_tiles.h"
#include "prt/precompute_context.h"
#include "prt/receivers/receiver_order.h"
#include "prt/receivers/receiver_sample.h"
#include "prt/tolerance.h"

namespace relumine::prt {

namespace {

/// Room for planes in all parts together: with less, many directions on borders between batches are
/// traced again. The limit must not depend on the number of parts.
constexpr std::uint64_t LeastPlanes = 2048;

/// Puts the counts of all parts together, tile by tile.
VisibleCounts joined_counts(const Transfer& plan, std::span<PartLight> parts) {
    if (parts.size() == 1 && parts[0].counts.num_receivers == plan.num_receivers() &&
        parts[0].counts.num_leaves == plan.num_clusters())
        return std::move(parts[0].counts);
    VisibleCounts whole{.num_receivers = plan.num_receivers(), .num_leaves = plan.num_clusters()};
    const std::size_t num_words = whole.num_blocks() * whole.words_per_block();
    whole.visible.reserve(num_words);
    whole.mixed.reserve(num_words);
    for (std::size_t tile = 0; tile < whole.num_tiles(); ++tile) {
        const VisibleCounts& part = parts[tile % parts.size()].counts;
        const std::size_t own_tile = tile / parts.size();
        const std::size_t num_blocks = whole.tile_begin(tile + 1) - whole.tile_begin(tile);
        if (part.num_leaves != whole.num_leaves || own_tile >= part.num_tiles() ||
            part.tile_begin(own_tile + 1) - part.tile_begin(own_tile) != num_blocks)
            throw std::invalid_argument("expected the counts of all tiles");
        const auto begin =
            static_cast<std::ptrdiff_t>(part.tile_begin(own_tile) * part.words_per_block());
        const auto end =
            static_cast<std::ptrdiff_t>(part.tile_begin(own_tile + 1) * part.words_per_block());
        const auto append = [&](auto& to, const auto& from, std::ptrdiff_t first,
                                std::ptrdiff_t last) {
            to.insert(to.end(), from.begin() + first, from.begin() + last);
        };
        append(whole.visible, part.visible, begin, end);
        append(whole.mixed, part.mixed, begin, end);
        const auto pairs_before = [&](std::ptrdiff_t word) {
            const auto at = static_cast<std::size_t>(word);
            return static_cast<std::ptrdiff_t>(BlockSize * (at < part.mixed_before.size()
                                                                ? part.mixed_before[at]
                                                                : part.num_mixed()));
        };
        append(whole.counts, part.counts, pairs_before(begin), pairs_before(end));
    }
    whole.index();
    return whole;
}

/// Puts the blocks of a lobe together, likewise.
LobeCuts joined_cuts(const VisibleCounts& whole, std::span<PartLight> parts, std::size_t lobe) {
    if (parts.size() == 1)
        return std::move(parts[0].glossy->lobes[lobe]);
    LobeCuts cuts;
    for (std::size_t tile = 0; tile < whole.num_tiles(); ++tile) {
        const LobeCuts& part = parts[tile % parts.size()].glossy->lobes[lobe];
        const std::size_t first = tile / parts.size() * VisibleCounts::TileBlocks;
        const std::size_t num_blocks = whole.tile_begin(tile + 1) - whole.tile_begin(tile);
        if (first + num_blocks >= part.begin.size())
            throw std::invalid_argument("expected the highlights of all tiles");
        cuts.append(part, first, num_blocks);
    }
    return cuts;
}

} // namespace

Transfer plan_clusters(const Receivers& receivers, const Blockers& blockers,
                       const PrecomputeOptions& options, const Work& work,
                       PrecomputeStatistics* statistics, Transfer* of_sample) {
    Transfer plan;
    plan.order = spatial_order(receivers);
    Transfer sampled = precompute(sample_of(receivers, plan.order), blockers,
                                  for_sample(options, receivers.size()), work, statistics);
    plan.quadtree = sampled.quadtree;
    plan.num_points = receivers.num_points();
    for (const std::uint32_t receiver : plan.order)
        plan.normals.push_back(receivers.normals[receiver]);
    if (of_sample != nullptr)
        *of_sample = std::move(sampled);
    return plan;
}

std::size_t num_sampled_receivers(std::size_t num_receivers) {
    const ReceiverSample blocks(num_receivers);
    const std::size_t last = blocks.num_blocks() - 1;
    return last * BlockSize + blocks.end(last) - blocks.begin(last);
}

std::vector<std::uint32_t> sampled_receivers(const Transfer& plan) {
    const ReceiverSample blocks(plan.num_receivers());
    std::vector<std::uint32_t> result(plan.num_receivers());
    files::parallel_for(std::size_t{0}, result.size(), [&](std::size_t place) {
        const std::size_t block = blocks.block_for(place);
        const std::size_t begin = blocks.begin(block);
        const auto alike = [&](std::size_t sampled) {
            return glm::dot(plan.normals[place], plan.normals[sampled]);
        };
        const bool is_sampled = place >= begin && place < blocks.end(block);
        std::size_t best = is_sampled ? place : begin;
        for (std::size_t sampled = begin; sampled < blocks.end(block) && !is_sampled; ++sampled)
            if (alike(sampled) > alike(best))
                best = sampled;
        // Blocks of the sample are full but for the last.
        result[place] = static_cast<std::uint32_t>(block * BlockSize + best - begin);
    });
    return result;
}

VisibleCounts part_counts(const Receivers& receivers, const Transfer& plan,
                          const Blockers& blockers, const PrecomputeOptions& options,
                          const Work& work, PrecomputeStatistics* statistics) {
    const Part part = work.team.part();
    if (part.index >= part.count || part.count > MaxParts)
        throw std::invalid_argument(fmt::format("expected a part among {} at most, got {} of {}",
                                                MaxParts, std::uint64_t{part.index} + 1,
                                                part.count));
    PrecomputeOptions of_part = options;
    const std::size_t plane_bytes = (receivers.size() + 63) / 64 * 8;
    of_part.plane_bytes = std::max(of_part.plane_bytes, LeastPlanes * plane_bytes);
    return precompute(receivers, blockers, of_part, work, {.given = &plan, .has_clusters = true},
                      statistics)
        .counts;
}

void join_highlights_and_bounces(Scene& scene, std::span<PartLight> parts,
                                 BounceStatistics* statistics) {
    if (parts.empty())
        throw std::invalid_argument("expected parts, got none");
    const bool has_highlights = parts.front().glossy.has_value();
    const bool has_bounces = parts.front().bounces.has_value();
    for (const PartLight& part : parts)
        if (part.glossy.has_value() != has_highlights || part.bounces.has_value() != has_bounces)
            throw std::invalid_argument("expected the same light in all parts");
    Transfer& transfer = scene.transfer;
    if (has_highlights) {
        const VisibleCounts shape{.num_receivers = transfer.num_receivers(),
                                  .num_leaves = transfer.num_clusters()};
        GlossyTransfer& glossy = transfer.glossy.emplace();
        for (std::size_t lobe = 0; lobe < NumGlossyLobes; ++lobe)
            glossy.lobes[lobe] = joined_cuts(shape, parts, lobe);
    }
    std::vector<BounceSamples> samples;
    for (PartLight& part : parts) {
        part.glossy.reset();
        if (has_bounces)
            samples.push_back(std::exchange(part.bounces, {}).value());
    }
    if (has_bounces)
        scene.bounces = join_bounces(scene.receivers, transfer, std::move(samples), statistics);
}

void join_light(Scene& scene, std::span<PartLight> parts, BounceStatistics* statistics) {
    if (parts.empty())
        throw std::invalid_argument("expected parts, got none");
    scene.transfer.counts = joined_counts(scene.transfer, parts);
    for (PartLight& part : parts)
        part.counts = {};
    join_highlights_and_bounces(scene, parts, statistics);
    set_surfaces(scene.transfer, scene.receivers);
}

} // namespace relumine::prt
