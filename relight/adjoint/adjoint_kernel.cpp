#include "relight/adjoint/adjoint_kernel.h"

#include <algorithm>

#include "prt/clusters/lattice.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/adjoint/adjoint_kernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "files/parallel.h"
#include "relight/kernels/block_loops-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The lanes of a cluster's sums, [channel x axis][lane].
using LaneSums = std::array<std::array<float, prt::BlockSize>, NumWeightSums>;

/// n . gate > 0, with the roundings of the kernel that lights blocks.
HWY_INLINE hn::Mask<Floats> is_above(const BlockNormals& normals, std::size_t lane,
                                     const float* gate) {
    const Floats d;
    return hn::Gt(Normals<Floats>(normals, lane).dot(gate), hn::Zero(d));
}

/// Returns the sum of 16 lanes, in the same order for vectors of any width.
double sum_of_lanes(const std::array<float, prt::BlockSize>& lanes) {
    const hn::CappedTag<float, 4> d;
    const auto even = hn::Add(hn::LoadU(d, lanes.data()), hn::LoadU(d, lanes.data() + 8));
    const auto odd = hn::Add(hn::LoadU(d, lanes.data() + 4), hn::LoadU(d, lanes.data() + 12));
    return static_cast<double>(hn::GetLane(hn::SumOfLanes(d, hn::Add(even, odd))));
}

/// Tiles that are walked through together: so many that adding up lanes takes little time.
constexpr std::size_t TilesPerGroup = 4;

/// The pairs of a tile and a word that the kernel of lighting adds per receiver, by cluster.
struct TilePairs {
    /// [cluster] blocks that see it in part, and whole across a horizon.
    std::array<std::uint64_t, 64> mixed;
    std::array<std::uint64_t, 64> across;
    /// [block] counts of its next mixed cluster
    std::array<const std::uint8_t*, prt::VisibleCounts::TileBlocks> counts;
    const BlockNormals* normals;
    const BlockWeights::Block* weights;

    /// Returns the clusters that have pairs.
    std::uint64_t set(const BlockScene& scene, std::size_t tile, std::size_t w,
                      const BlockWeights& of_all) {
        const std::size_t begin = scene.counts.tile_begin(tile);
        normals = scene.normals.data() + begin;
        weights = of_all.blocks.data() + begin;
        mixed = {};
        across = {};
        std::uint64_t any = 0;
        const auto add = [](std::uint64_t clusters, std::size_t block, auto& blocks_of) {
            for_bits(clusters,
                     [&](std::size_t cluster) { blocks_of[cluster] |= std::uint64_t{1} << block; });
        };
        for_pairs(scene, tile, w, ~std::uint64_t{0}, [&](std::size_t block, const Pairs& pairs) {
            // Clusters go through these counts across the order in which they lie in memory.
            constexpr std::size_t CacheLine = 64;
            counts[block] = pairs.counts;
            const std::size_t size = num_counts(pairs.mixed);
            for (std::size_t at = 0; at < size; at += CacheLine)
                hwy::Prefetch(pairs.counts + at);
            any |= pairs.mixed | pairs.across;
            add(pairs.mixed, block, mixed);
            add(pairs.across, block, across);
        });
        return any;
    }
};

/// Sums of some receivers for a cluster, [channel x axis].
struct Sums {
    hn::Vec<Floats> xr, yr, zr, xg, yg, zg, xb, yb, zb;

    // Written out: g++ compiles an implicit constructor without the instruction set of the
    // functions around it.
    HWY_INLINE Sums()
        : xr(hn::Zero(Floats())), yr(xr), zr(xr), xg(xr), yg(xr), zg(xr), xb(xr), yb(xr), zb(xr) {}

    /// Adds weights of the channels times normals.
    HWY_INLINE void add(const BlockNormals& normals, std::size_t lane, hn::Vec<Floats> red,
                        hn::Vec<Floats> green, hn::Vec<Floats> blue) {
        const Floats d;
        const auto x = hn::LoadU(d, normals.axes[0].data() + lane);
        const auto y = hn::LoadU(d, normals.axes[1].data() + lane);
        const auto z = hn::LoadU(d, normals.axes[2].data() + lane);
        xr = hn::MulAdd(red, x, xr);
        yr = hn::MulAdd(red, y, yr);
        zr = hn::MulAdd(red, z, zr);
        xg = hn::MulAdd(green, x, xg);
        yg = hn::MulAdd(green, y, yg);
        zg = hn::MulAdd(green, z, zg);
        xb = hn::MulAdd(blue, x, xb);
        yb = hn::MulAdd(blue, y, yb);
        zb = hn::MulAdd(blue, z, zb);
    }
    HWY_INLINE void store(LaneSums& lanes, std::size_t lane) const {
        const Floats d;
        hn::StoreU(xr, d, lanes[0].data() + lane);
        hn::StoreU(yr, d, lanes[1].data() + lane);
        hn::StoreU(zr, d, lanes[2].data() + lane);
        hn::StoreU(xg, d, lanes[3].data() + lane);
        hn::StoreU(yg, d, lanes[4].data() + lane);
        hn::StoreU(zg, d, lanes[5].data() + lane);
        hn::StoreU(xb, d, lanes[6].data() + lane);
        hn::StoreU(yb, d, lanes[7].data() + lane);
        hn::StoreU(zb, d, lanes[8].data() + lane);
    }
};

/// Adds what some receivers of a block have of a cluster. `count` is how much they see of it.
template<bool ChannelsDiffer>
HWY_INLINE void add_inside(hn::Vec<Floats> count, const TilePairs& tile, std::size_t block,
                           std::size_t lane, const float* gates, Sums& sums) {
    const BlockNormals& normals = tile.normals[block];
    const auto red = hn::IfThenElseZero(is_above(normals, lane, gates), count);
    auto green = red, blue = red;
    if (ChannelsDiffer) {
        green = hn::IfThenElseZero(is_above(normals, lane, gates + 3), count);
        blue = hn::IfThenElseZero(is_above(normals, lane, gates + 6), count);
    }
    const auto weight = [&](std::size_t channel) HWY_ATTR {
        return hn::LoadU(Floats(), tile.weights[block].channels[channel].data() + lane);
    };
    sums.add(normals, lane, hn::Mul(red, weight(0)), hn::Mul(green, weight(1)),
             hn::Mul(blue, weight(2)));
}

/// Adds the pairs of a cluster, and goes on to the next one.
template<bool ChannelsDiffer>
void add_cluster(std::span<TilePairs> tiles, std::size_t cluster, const float* gates,
                 WeightSums& result) {
    const Floats d;
    LaneSums lanes;
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
        Sums sums;
        for (const TilePairs& tile : tiles) {
            for_bits(tile.mixed[cluster], [&](std::size_t block) HWY_ATTR {
                const auto count = load_counts(d, tile.counts[block] + lane);
                add_inside<ChannelsDiffer>(count, tile, block, lane, gates, sums);
            });
            for_bits(tile.across[cluster], [&](std::size_t block) HWY_ATTR {
                const auto full = hn::Set(d, static_cast<float>(prt::FullCount));
                add_inside<ChannelsDiffer>(full, tile, block, lane, gates, sums);
            });
        }
        sums.store(lanes, lane);
    }
    for (std::size_t i = 0; i < NumWeightSums; ++i)
        result[i] += sum_of_lanes(lanes[i]);
    for (TilePairs& tile : tiles)
        for_bits(tile.mixed[cluster],
                 [&](std::size_t block) { tile.counts[block] += prt::BlockSize; });
}

/// Adds the runs of clusters that blocks see whole: where one begins, and where it has ended.
void add_runs(const BlockScene& scene, std::size_t tile, std::size_t w, const WeightSums* wholes,
              OpenRuns& open, std::span<WeightSums> steps) {
    for_runs(scene, tile, w, ~std::uint64_t{0}, open, [&](std::size_t block, const Runs& runs) {
        const WeightSums& whole = wholes[block];
        for_bits(runs.edges, [&](std::size_t cluster) {
            if (cluster >= steps.size())
                return;
            const double sign = (runs.visible >> cluster & 1u) != 0 ? 1.0 : -1.0;
            for (std::size_t i = 0; i < whole.size(); ++i)
                steps[cluster][i] += sign * whole[i];
        });
    });
}

/// Adds a group of tiles to the clusters of words [first_word, last_word).
void add_tiles(const BlockScene& scene, std::size_t first_tile, std::size_t last_tile,
               std::size_t first_word, std::size_t last_word, const Gates& gates,
               const BlockWeights& weights, ClusterWeights& sums) {
    const prt::VisibleCounts& counts = scene.counts;
    std::array<OpenRuns, TilesPerGroup> open;
    std::array<TilePairs, TilesPerGroup> pairs;
    const std::span<TilePairs> of_group(pairs.data(), last_tile - first_tile);
    for (std::size_t tile = first_tile; first_word > 0 && tile < last_tile; ++tile)
        open[tile - first_tile] = open_after(scene, tile, first_word - 1);
    for (std::size_t w = first_word; w < last_word; ++w) {
        std::uint64_t any = 0;
        for (std::size_t tile = first_tile; tile < last_tile; ++tile) {
            const std::size_t begin = counts.tile_begin(tile);
            add_runs(scene, tile, w, weights.whole.data() + begin, open[tile - first_tile],
                     std::span(sums.whole_steps).subspan(w * 64));
            any |= pairs[tile - first_tile].set(scene, tile, w, weights);
        }
        for_bits(any, [&](std::size_t cluster) {
            const float* gate = gates.vectors.data() + (w * 64 + cluster) * NumWeightSums;
            WeightSums& of_cluster = sums.gated[w * 64 + cluster];
            if ((gates.differ[w] >> cluster & 1u) != 0)
                add_cluster<true>(of_group, cluster, gate, of_cluster);
            else
                add_cluster<false>(of_group, cluster, gate, of_cluster);
        });
    }
}

void add_receivers(const BlockScene& scene, std::size_t first_word, std::size_t last_word,
                   const Gates& gates, const BlockWeights& weights, ClusterWeights& sums) {
    const std::size_t num_tiles = scene.counts.num_tiles();
    for (std::size_t tile = 0; tile < num_tiles; tile += TilesPerGroup)
        add_tiles(scene, tile, std::min(tile + TilesPerGroup, num_tiles), first_word, last_word,
                  gates, weights, sums);
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

namespace {
HWY_EXPORT(add_receivers);
} // namespace

void add_receivers(const BlockScene& scene, std::size_t first_word, std::size_t last_word,
                   const Gates& gates, const BlockWeights& weights, ClusterWeights& sums) {
    HWY_DYNAMIC_DISPATCH(add_receivers)
    (scene, first_word, last_word, gates, weights, sums);
}

BlockWeights::BlockWeights(std::span<const glm::vec3> weights, std::span<const glm::vec3> normals)
    : blocks((weights.size() + prt::BlockSize - 1) / prt::BlockSize), whole(blocks.size()) {
    files::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t block) {
        const std::size_t begin = block * prt::BlockSize;
        const std::size_t end = std::min(begin + prt::BlockSize, weights.size());
        for (std::size_t place = begin; place < end; ++place)
            for (int channel = 0; channel < 3; ++channel) {
                const auto c = static_cast<std::size_t>(channel);
                blocks[block].channels[c][place - begin] = weights[place][channel];
                for (int axis = 0; axis < 3; ++axis)
                    whole[block][3 * c + static_cast<std::size_t>(axis)] +=
                        static_cast<double>(prt::FullCount) *
                        static_cast<double>(weights[place][channel]) *
                        static_cast<double>(normals[place][axis]);
            }
    });
}

} // namespace relumine::relight
#endif // HWY_ONCE
