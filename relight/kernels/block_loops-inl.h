// What the kernels that light blocks share. Compiled once per instruction set, inside a Highway
// block.
#if defined(RELUMINE_RELIGHT_BLOCK_LOOPS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RELUMINE_RELIGHT_BLOCK_LOOPS_INL_H
#undef RELUMINE_RELIGHT_BLOCK_LOOPS_INL_H
#else
#define RELUMINE_RELIGHT_BLOCK_LOOPS_INL_H
#endif

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "files/wasm_doubles-inl.h"
#include "relight/kernels/block_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Sums of float for the 16 receivers, [channel][receiver].
using FloatSum = std::array<std::array<float, prt::BlockSize>, 3>;

using Floats = hn::CappedTag<float, prt::BlockSize>;

/// Normals of some of a block's receivers.
template<class D>
struct Normals {
    using Vec = hn::Vec<D>;
    Vec x, y, z;

    Normals(const BlockNormals& normals, std::size_t lane)
        : x(hn::LoadU(D(), normals.axes[0].data() + lane)),
          y(hn::LoadU(D(), normals.axes[1].data() + lane)),
          z(hn::LoadU(D(), normals.axes[2].data() + lane)) {}

    /// Returns n.e.
    [[nodiscard]] Vec dot(const float* e) const {
        const D d;
        const auto along_z = hn::Mul(z, hn::Set(d, e[2]));
        return hn::MulAdd(x, hn::Set(d, e[0]), hn::MulAdd(y, hn::Set(d, e[1]), along_z));
    }
};

/// Returns counts as numbers, float or double.
template<class D>
HWY_INLINE hn::Vec<D> load_counts(D d, const std::uint8_t* counts) {
    const hn::Rebind<std::uint8_t, D> bytes;
    const hn::Rebind<std::int32_t, D> integers;
    const auto whole = hn::PromoteTo(integers, hn::LoadU(bytes, counts));
    if constexpr (sizeof(hn::TFromD<D>) == sizeof(float))
        return hn::ConvertTo(d, whole);
    else
        return hn::PromoteTo(d, whole);
}

HWY_INLINE std::size_t first_bit(std::uint64_t bits) {
    return static_cast<std::size_t>(std::countr_zero(bits));
}

/// Returns how many counts the mixed pairs of a word have.
HWY_INLINE std::size_t num_counts(std::uint64_t mixed) {
    return static_cast<std::size_t>(std::popcount(mixed)) * prt::BlockSize;
}

/// Calls visit(index) for the set bits: blocks of a tile, clusters of a word.
template<class Visit>
HWY_INLINE void for_bits(std::uint64_t bits, const Visit& visit) {
    for (; bits != 0; bits &= bits - 1)
        visit(first_bit(bits));
}

// The walk: [JN, Eq. 8] goes over all pairs of a block and a cluster, a tile of blocks and a word
// of clusters at a time. Clusters that a block sees whole add up before they meet its normals, as
// runs: what comes before a run's end, less what comes before its beginning. The others add up for
// each receiver.

/// Clusters of a word that a block sees whole, above its receivers' horizons.
struct Runs {
    std::uint64_t visible;
    /// Where a run begins, which is visible there, or has ended before.
    std::uint64_t edges;
};

/// The blocks of a tile that are in the middle of a run, from word to word.
class OpenRuns {
public:
    /// Goes on to a block's next word.
    HWY_INLINE Runs next(std::size_t block, std::uint64_t visible) {
        const Runs runs{visible, visible ^ (visible << 1 | (open_ >> block & 1u))};
        open_ = (open_ & ~(std::uint64_t{1} << block)) | visible >> 63 << block;
        return runs;
    }
    /// A run up to the last bit of the last word ends behind it.
    [[nodiscard]] HWY_INLINE Runs last(std::size_t block) const { return {0, open_ >> block & 1u}; }

private:
    std::uint64_t open_ = 0;
};

HWY_INLINE const TileWord& tile_word(const BlockScene& scene, std::size_t tile, std::size_t w) {
    return scene.words.words[tile * scene.counts.words_per_block() + w];
}

/// Calls visit(block, runs) for the chosen blocks of a tile with runs that begin or end in a word.
template<class Visit>
HWY_INLINE void for_runs(const BlockScene& scene, std::size_t tile, std::size_t w,
                         std::uint64_t chosen, OpenRuns& open, const Visit& visit) {
    const TileWord& blocks = tile_word(scene, tile, w);
    const std::uint64_t* words =
        scene.counts.visible.data() + scene.counts.word(scene.counts.tile_begin(tile), w);
    for_bits(blocks.edges & chosen, [&](std::size_t block) {
        visit(block, open.next(block, words[block] & ~scene.words.across_of(blocks, block)));
    });
}

/// Returns the runs that are open behind a word.
inline OpenRuns open_after(const BlockScene& scene, std::size_t tile, std::size_t w) {
    OpenRuns open;
    const TileWord& blocks = tile_word(scene, tile, w);
    const std::uint64_t* words =
        scene.counts.visible.data() + scene.counts.word(scene.counts.tile_begin(tile), w);
    for_bits(blocks.visible, [&](std::size_t block) {
        open.next(block, words[block] & ~scene.words.across_of(blocks, block));
    });
    return open;
}

/// The clusters of a block and word that add up for each receiver.
struct Pairs {
    /// Seen in part.
    std::uint64_t mixed = 0;
    /// Seen whole, across a horizon.
    std::uint64_t across = 0;
    /// The counts of the first cluster in `mixed`; those of the others follow.
    const std::uint8_t* counts = nullptr;

    /// Returns the counts of a cluster in `mixed`.
    [[nodiscard]] HWY_INLINE const std::uint8_t* counts_of(std::size_t cluster) const {
        return counts + num_counts(mixed & ((std::uint64_t{1} << cluster) - 1));
    }
};

/// Calls visit(block, pairs) for the chosen blocks of a tile that have pairs in a word. Returns
/// these blocks.
template<class Visit>
HWY_INLINE std::uint64_t for_pairs(const BlockScene& scene, std::size_t tile, std::size_t w,
                                   std::uint64_t chosen, const Visit& visit) {
    const TileWord& blocks = tile_word(scene, tile, w);
    const std::uint64_t* words =
        scene.counts.mixed.data() + scene.counts.word(scene.counts.tile_begin(tile), w);
    const std::uint8_t* counts = scene.counts.counts.data() + blocks.mixed_before * prt::BlockSize;
    const std::uint64_t with_pairs = (blocks.mixed | blocks.across) & chosen;
    for_bits(blocks.mixed | with_pairs, [&](std::size_t block) {
        const Pairs pairs{words[block], scene.words.across_of(blocks, block), counts};
        counts += num_counts(pairs.mixed);
        if ((chosen >> block & 1u) != 0)
            visit(block, pairs);
    });
    return with_pairs;
}

/// Blocks whose sums in float, of so many words, are still to be added to those in double.
template<std::size_t Words>
class FloatWords {
public:
    /// Calls add(block) for them after every so many words, and after the last.
    template<class Add>
    HWY_INLINE void after(std::size_t w, std::size_t num_words, std::uint64_t blocks,
                          const Add& add) {
        summed_ |= blocks;
        if (w % Words != Words - 1 && w != num_words - 1)
            return;
        for_bits(summed_, add);
        summed_ = 0;
    }

private:
    std::uint64_t summed_ = 0;
};

/// Radiance of some receivers, per channel.
struct Sum {
    hn::Vec<Floats> red, green, blue;

    // Written out: g++ compiles an implicit constructor without the instruction set of the
    // functions around it.
    Sum() : red(hn::Zero(Floats())), green(red), blue(red) {}
    Sum(const FloatSum& sum, std::size_t lane)
        : red(hn::LoadU(Floats(), sum[0].data() + lane)),
          green(hn::LoadU(Floats(), sum[1].data() + lane)),
          blue(hn::LoadU(Floats(), sum[2].data() + lane)) {}

    void store(FloatSum& sum, std::size_t lane) const {
        hn::StoreU(red, Floats(), sum[0].data() + lane);
        hn::StoreU(green, Floats(), sum[1].data() + lane);
        hn::StoreU(blue, Floats(), sum[2].data() + lane);
    }
    void add(hn::Vec<Floats> part, const float* colour) {
        const Floats d;
        red = hn::MulAdd(part, hn::Set(d, colour[0]), red);
        green = hn::MulAdd(part, hn::Set(d, colour[1]), green);
        blue = hn::MulAdd(part, hn::Set(d, colour[2]), blue);
    }
};

/// The light of a word's clusters, in one environment.
struct WordLights {
    const float* vectors;
    const float* directionals;
    std::uint64_t spread;

    WordLights() = default;
    WordLights(const ClusterLights& lights, std::size_t w)
        : vectors(lights.vectors.data() + w * 64 * ClusterLights::Stride),
          directionals(lights.directionals.data() + w * 64 * ClusterLights::DirectionalStride),
          spread(lights.spread[w]) {}
};

/// Adds max(n.E, 0) of cluster i of a word. Without AnySpread it is not spread.
template<bool AnySpread>
HWY_INLINE void add_cluster(const WordLights& lights, std::size_t i, const Normals<Floats>& n,
                            Sum& sum) {
    const auto zero = hn::Zero(Floats());
    if (AnySpread && (lights.spread >> i & 1u) != 0) {
        const float* e = lights.vectors + i * ClusterLights::Stride;
        sum.red = hn::Add(sum.red, hn::Max(n.dot(e), zero));
        sum.green = hn::Add(sum.green, hn::Max(n.dot(e + 3), zero));
        sum.blue = hn::Add(sum.blue, hn::Max(n.dot(e + 6), zero));
    } else {
        const float* directional = lights.directionals + i * ClusterLights::DirectionalStride;
        sum.add(hn::Max(n.dot(directional), zero), directional + 3);
    }
}

/// Adds float sums to those in double.
HWY_INLINE void add(const FloatSum& sum, BlockLight& light) {
    const hn::CappedTag<double, prt::BlockSize> d;
    const hn::Rebind<float, decltype(d)> floats;
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
            double* total = light.mixed[channel].data() + lane;
            const auto more = hn::PromoteTo(d, hn::LoadU(floats, sum[channel].data() + lane));
            hn::StoreU(hn::Add(hn::LoadU(d, total), more), d, total);
        }
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif // toggle
