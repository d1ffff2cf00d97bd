#include "relight/adjoint/harmonic_adjoint_kernel.h"

#include <algorithm>
#include <span>

#include "files/parallel.h"
#include "prt/clusters/lattice.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/adjoint/harmonic_adjoint_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "relight/kernels/block_loops-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

namespace {

using Lane = hn::CappedTag<float, prt::BlockSize>;
using Floats = hn::Vec<Lane>;
constexpr std::size_t WordClusters = 64;
constexpr std::size_t MostStride = 3 * MaxHarmonics;

/// 16 receivers' sums of a channel.
struct alignas(64) LaneSum {
    std::array<float, prt::BlockSize> lanes{};

    HWY_INLINE void add(std::size_t lane, Floats value) {
        const Lane d;
        hn::Store(hn::Add(hn::Load(d, lanes.data() + lane), value), d, lanes.data() + lane);
    }
    HWY_INLINE void multiply_add(std::size_t lane, Floats a, Floats b) {
        const Lane d;
        hn::Store(hn::MulAdd(a, b, hn::Load(d, lanes.data() + lane)), d, lanes.data() + lane);
    }
    /// In the same order for vectors of any width.
    [[nodiscard]] double sum() const {
        std::array<double, 4> parts{};
        for (std::size_t i = 0; i < lanes.size(); ++i)
            parts[i % parts.size()] += static_cast<double>(lanes[i]);
        return (parts[0] + parts[1]) + (parts[2] + parts[3]);
    }
};

/// The pairs of a tile and a word.
struct TilePairs {
    std::array<Pairs, prt::VisibleCounts::TileBlocks> blocks;
    /// Blocks that have any, and clusters that have any.
    std::uint64_t has_pairs = 0, clusters = 0;
};

/// What the clusters of a group sum up, of one word and tile.
template<std::size_t Count>
struct GroupSums {
    std::array<std::array<LaneSum, 3>, WordClusters> fluxes;
    std::array<LaneSum, 3 * Count> bases;

    void clear(std::uint64_t clusters) {
        for_bits(clusters, [&](std::size_t cluster) { fluxes[cluster] = {}; });
        bases = {};
    }
};

/// Returns the part of a group that is above the receivers' horizons, as light_harmonics() has it.
HWY_INLINE Floats part_above(const HarmonicGroup& group, const BlockNormals& normals,
                             std::size_t lane) {
    const Lane d;
    auto above = hn::Set(d, 0.5f);
    auto squares = hn::Zero(d);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto normal = hn::LoadU(d, normals.axes[axis].data() + lane);
        squares = hn::MulAdd(normal, normal, squares);
        above = hn::MulAdd(normal, hn::Set(d, group.slope[axis]), above);
    }
    const auto all = hn::Max(hn::MulAdd(squares, hn::Set(d, -2.0f), hn::Set(d, 1.0f)), hn::Zero(d));
    return hn::Min(hn::Max(hn::Add(above, all), hn::Zero(d)), hn::Set(d, 1.0f));
}

/// Adds a block to the clusters of a group. `basis` is the group's, `flux` the word's first
/// cluster's.
template<std::size_t Count>
HWY_INLINE void add_block(const Pairs& pairs, std::uint64_t of_group, Floats above,
                          std::size_t lane, const float* weights, const float* basis,
                          const float* flux, GroupSums<Count>& sums) {
    const Lane d;
    std::array<LaneSum, 3> counted; // the weights of a flux
    std::array<LaneSum, 3> flows;   // counts times fluxes
    for (std::size_t channel = 0; channel < 3; ++channel) {
        auto sum = hn::Zero(d);
        for (std::size_t k = channel * Count; k < (channel + 1) * Count; ++k)
            sum = hn::MulAdd(hn::LoadU(d, weights + k * prt::BlockSize + lane),
                             hn::Set(d, basis[k]), sum);
        hn::Store(hn::Mul(sum, above), d, counted[channel].lanes.data() + lane);
    }
    const auto add = [&](std::size_t cluster, Floats count) HWY_ATTR {
        for (std::size_t channel = 0; channel < 3; ++channel) {
            sums.fluxes[cluster][channel].multiply_add(
                lane, count, hn::Load(d, counted[channel].lanes.data() + lane));
            flows[channel].multiply_add(lane, count, hn::Set(d, flux[cluster * 3 + channel]));
        }
    };
    for_bits(of_group & pairs.mixed, [&](std::size_t cluster) HWY_ATTR {
        add(cluster, load_counts(d, pairs.counts_of(cluster) + lane));
    });
    for_bits(of_group & pairs.across, [&](std::size_t cluster) HWY_ATTR {
        add(cluster, hn::Set(d, static_cast<float>(prt::FullCount)));
    });
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const auto flow = hn::Mul(above, hn::Load(d, flows[channel].lanes.data() + lane));
        for (std::size_t k = channel * Count; k < (channel + 1) * Count; ++k)
            sums.bases[k].multiply_add(lane, flow,
                                       hn::LoadU(d, weights + k * prt::BlockSize + lane));
    }
}

/// Adds the pairs of a tile and a word, group by group.
template<std::size_t Count>
void add_pairs(const BlockScene& scene, std::size_t begin, std::size_t w, const TilePairs& tile,
               const ClusterHarmonics& lights, const HarmonicWeights& weights,
               GroupSums<Count>& scratch, HarmonicSums& sums) {
    const std::size_t cluster = w * WordClusters;
    for (std::uint64_t rest = tile.clusters; rest != 0;) {
        const std::size_t index = lights.group_of()[cluster + first_bit(rest)];
        const HarmonicGroup& group = lights.groups()[index];
        const std::size_t end = group.end - cluster;
        const std::uint64_t of_group =
            end < WordClusters ? rest & ((std::uint64_t{1} << end) - 1) : rest;
        rest &= ~of_group;
        scratch.clear(of_group);
        for_bits(tile.has_pairs, [&](std::size_t block) {
            const Pairs& pairs = tile.blocks[block];
            if ((of_group & (pairs.mixed | pairs.across)) == 0)
                return;
            for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(Lane()))
                add_block<Count>(
                    pairs, of_group, part_above(group, scene.normals[begin + block], lane), lane,
                    weights.lanes.data() + (begin + block) * 3 * Count * prt::BlockSize,
                    lights.bases().data() + index * 3 * Count, lights.fluxes().data() + cluster * 3,
                    scratch);
        });
        for_bits(of_group, [&](std::size_t bit) {
            for (std::size_t channel = 0; channel < 3; ++channel)
                sums.fluxes[(cluster + bit) * 3 + channel] += scratch.fluxes[bit][channel].sum();
        });
        const std::size_t slot = sums.first_slot[w] + index - lights.group_of()[cluster];
        for (std::size_t k = 0; k < 3 * Count; ++k)
            sums.bases[slot * 3 * Count + k] += scratch.bases[k].sum();
    }
}

/// Adds the runs of clusters that a block sees whole: where one begins, and where it has ended.
void add_runs(const Runs& runs, std::span<const double> whole, std::span<double> steps) {
    for_bits(runs.edges, [&](std::size_t cluster) {
        if (cluster >= steps.size() / whole.size())
            return;
        const double sign = (runs.visible >> cluster & 1u) != 0 ? 1.0 : -1.0;
        for (std::size_t i = 0; i < whole.size(); ++i)
            steps[cluster * whole.size() + i] += sign * whole[i];
    });
}

/// Adds a tile to the clusters of words [first_word, last_word).
template<std::size_t Count>
void add_tile(const BlockScene& scene, std::size_t tile, std::size_t first_word,
              std::size_t last_word, const ClusterHarmonics& lights, const HarmonicWeights& weights,
              GroupSums<Count>& scratch, HarmonicSums& sums) {
    constexpr std::size_t Stride = 3 * Count;
    constexpr std::uint64_t All = ~std::uint64_t{0};
    const std::size_t begin = scene.counts.tile_begin(tile);
    OpenRuns open = first_word > 0 ? open_after(scene, tile, first_word - 1) : OpenRuns();
    for (std::size_t w = first_word; w < last_word; ++w) {
        const std::span<double> steps =
            std::span(sums.whole_steps).subspan(w * WordClusters * Stride);
        for_runs(scene, tile, w, All, open, [&](std::size_t block, const Runs& runs) {
            add_runs(runs, std::span(weights.whole).subspan((begin + block) * Stride, Stride),
                     steps);
        });
        TilePairs pairs;
        pairs.has_pairs =
            for_pairs(scene, tile, w, All, [&](std::size_t block, const Pairs& of_block) {
                pairs.blocks[block] = of_block;
                pairs.clusters |= of_block.mixed | of_block.across;
            });
        add_pairs<Count>(scene, begin, w, pairs, lights, weights, scratch, sums);
    }
}

template<std::size_t Count>
void add_tiles(const BlockScene& scene, std::size_t first_word, std::size_t last_word,
               const ClusterHarmonics& lights, const HarmonicWeights& weights, HarmonicSums& sums) {
    GroupSums<Count> scratch;
    for (std::size_t tile = 0; tile < scene.counts.num_tiles(); ++tile)
        add_tile<Count>(scene, tile, first_word, last_word, lights, weights, scratch, sums);
}

} // namespace

void add_by_order(const BlockScene& scene, std::size_t first_word, std::size_t last_word,
                  const ClusterHarmonics& lights, const HarmonicWeights& weights,
                  HarmonicSums& sums) {
    if (lights.order() == 1)
        add_tiles<1>(scene, first_word, last_word, lights, weights, sums);
    else if (lights.order() == 2)
        add_tiles<4>(scene, first_word, last_word, lights, weights, sums);
    else
        add_tiles<9>(scene, first_word, last_word, lights, weights, sums);
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

namespace {
HWY_EXPORT(add_by_order);
} // namespace

void add_receivers(const BlockScene& scene, std::size_t first_word, std::size_t last_word,
                   const ClusterHarmonics& lights, const HarmonicWeights& weights,
                   HarmonicSums& sums) {
    HWY_DYNAMIC_DISPATCH(add_by_order)
    (scene, first_word, last_word, lights, weights, sums);
}

HarmonicWeights::HarmonicWeights(std::span<const glm::vec3> weights,
                                 std::span<const std::uint32_t> order_of)
    : stride(3 * weights.size() / order_of.size()) {
    const std::size_t num_blocks = (order_of.size() + prt::BlockSize - 1) / prt::BlockSize;
    const std::size_t count = stride / 3;
    lanes.resize(num_blocks * stride * prt::BlockSize);
    whole.resize(num_blocks * stride);
    files::parallel_for(std::size_t{0}, num_blocks, [&](std::size_t block) {
        const std::size_t begin = block * prt::BlockSize;
        for (std::size_t place = begin; place < std::min(begin + prt::BlockSize, order_of.size());
             ++place)
            for (std::size_t i = 0; i < stride; ++i) {
                const float weight =
                    weights[order_of[place] * count + i % count][static_cast<int>(i / count)];
                lanes[(block * stride + i) * prt::BlockSize + place - begin] = weight;
                whole[block * stride + i] +=
                    static_cast<double>(prt::FullCount) * static_cast<double>(weight);
            }
    });
}

HarmonicSums::HarmonicSums(const ClusterHarmonics& lights)
    : whole_steps(lights.group_of().size() * lights.stride()),
      fluxes(lights.group_of().size() * 3) {
    const std::span<const std::uint32_t> groups = lights.group_of();
    first_slot.push_back(0);
    for (std::size_t first = 0; first < groups.size(); first += 64)
        first_slot.push_back(first_slot.back() + groups[std::min(first + 64, groups.size()) - 1] -
                             groups[first] + 1);
    bases.resize(first_slot.back() * lights.stride());
}

} // namespace relumine::relight
#endif // HWY_ONCE
