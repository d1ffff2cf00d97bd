#include "relight/adjoint/adjoint_kernel.h"

#include <algorithm>
#include <bit>

#include "prt/clusters/lattice.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/adjoint/adjoint_kernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "files/parallel.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, prt::BlockSize>;

/// The lanes of a cluster's sums, [channel x axis][lane].
using LaneSums = std::array<std::array<float, prt::BlockSize>, NumWeightSums>;

/// Calls `visit` with the index of each set bit.
template<typename Visit>
HWY_INLINE void for_bits(std::uint64_t bits, const Visit& visit) {
    for (; bits != 0; bits &= bits - 1)
        visit(static_cast<std::size_t>(std::countr_zero(bits)));
}

/// n . gate > 0, with the roundings of the kernel that lights blocks.
HWY_INLINE hn::Mask<Floats> is_above(const BlockNormals& normals, std::size_t lane,
                                     const float* gate) {
    const Floats d;
    const auto along_z = hn::Mul(hn::LoadU(d, normals.axes[2].data() + lane), hn::Set(d, gate[2]));
    const auto along_yz =
        hn::MulAdd(hn::LoadU(d, normals.axes[1].data() + lane), hn::Set(d, gate[1]), along_z);
    const auto cosine =
        hn::MulAdd(hn::LoadU(d, normals.axes[0].data() + lane), hn::Set(d, gate[0]), along_yz);
    return hn::Gt(cosine, hn::Zero(d));
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
        const TileWord& blocks = scene.words.words[tile * scene.counts.words_per_block() + w];
        const std::uint64_t* words = scene.counts.mixed.data() + scene.counts.word(begin, w);
        const std::uint8_t* next =
            scene.counts.counts.data() + blocks.mixed_before * prt::BlockSize;
        normals = scene.normals.data() + begin;
        weights = of_all.blocks.data() + begin;
        mixed = {};
        across = {};
        std::uint64_t any = 0;
        for_bits(blocks.mixed, [&](std::size_t block) {
            // Clusters go through these counts across the order in which they lie in memory.
            constexpr std::size_t CacheLine = 64;
            const std::uint8_t* const end =
                next + static_cast<std::size_t>(std::popcount(words[block])) * prt::BlockSize;
            counts[block] = next;
            for (; next < end; next += CacheLine)
                hwy::Prefetch(next);
            next = end;
            any |= words[block];
            for_bits(words[block],
                     [&](std::size_t cluster) { mixed[cluster] |= std::uint64_t{1} << block; });
        });
        for_bits(blocks.across, [&](std::size_t block) {
            const std::uint64_t clusters = scene.words.across_of(blocks, block);
            any |= clusters;
            for_bits(clusters,
                     [&](std::size_t cluster) { across[cluster] |= std::uint64_t{1} << block; });
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
    const hn::Rebind<std::uint8_t, Floats> bytes;
    const hn::Rebind<std::int32_t, Floats> integers;
    LaneSums lanes;
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
        Sums sums;
        for (const TilePairs& tile : tiles) {
            for_bits(tile.mixed[cluster], [&](std::size_t block) HWY_ATTR {
                const auto count = hn::ConvertTo(
                    d, hn::PromoteTo(integers, hn::LoadU(bytes, tile.counts[block] + lane)));
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
/// `inside` has the blocks that see the word before up to its end.
void add_runs(const BlockScene& scene, const TileWord& blocks, const std::uint64_t* visible_words,
              const WeightSums* wholes, std::uint64_t& inside, WeightSums* steps,
              std::size_t num_clusters) {
    for_bits(blocks.edges, [&](std::size_t block) {
        const std::uint64_t visible = visible_words[block] & ~scene.words.across_of(blocks, block);
        const WeightSums& whole = wholes[block];
        const std::uint64_t edges = visible ^ (visible << 1 | (inside >> block & 1u));
        for_bits(edges, [&](std::size_t cluster) {
            if (cluster >= num_clusters)
                return;
            const double sign = (visible >> cluster & 1u) != 0 ? 1.0 : -1.0;
            for (std::size_t i = 0; i < whole.size(); ++i)
                steps[cluster][i] += sign * whole[i];
        });
        inside = (inside & ~(std::uint64_t{1} << block)) | visible >> 63 << block;
    });
}

/// The blocks of a tile that see the clusters of a word up to the last one, whole.
std::uint64_t inside_after(const BlockScene& scene, std::size_t tile, std::size_t w) {
    const TileWord& blocks = scene.words.words[tile * scene.counts.words_per_block() + w];
    const std::uint64_t* words =
        scene.counts.visible.data() + scene.counts.word(scene.counts.tile_begin(tile), w);
    std::uint64_t inside = 0;
    for_bits(blocks.visible, [&](std::size_t block) {
        inside |= (words[block] & ~scene.words.across_of(blocks, block)) >> 63 << block;
    });
    return inside;
}

/// Adds a group of tiles to the clusters of words [first_word, last_word).
void add_tiles(const BlockScene& scene, std::size_t first_tile, std::size_t last_tile,
               std::size_t first_word, std::size_t last_word, const Gates& gates,
               const BlockWeights& weights, ClusterWeights& sums) {
    const prt::VisibleCounts& counts = scene.counts;
    std::array<std::uint64_t, TilesPerGroup> inside{};
    std::array<TilePairs, TilesPerGroup> pairs;
    const std::span<TilePairs> of_group(pairs.data(), last_tile - first_tile);
    for (std::size_t tile = first_tile; first_word > 0 && tile < last_tile; ++tile)
        inside[tile - first_tile] = inside_after(scene, tile, first_word - 1);
    for (std::size_t w = first_word; w < last_word; ++w) {
        std::uint64_t any = 0;
        for (std::size_t tile = first_tile; tile < last_tile; ++tile) {
            const std::size_t begin = counts.tile_begin(tile);
            add_runs(scene, scene.words.words[tile * counts.words_per_block() + w],
                     counts.visible.data() + counts.word(begin, w), weights.whole.data() + begin,
                     inside[tile - first_tile], sums.whole_steps.data() + w * 64,
                     counts.num_leaves - w * 64);
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
