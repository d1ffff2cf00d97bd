#include "relight/kernels/update_kernel.h"

#include <array>
#include <vector>

#include "prt/clusters/lattice.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/kernels/update_kernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "relight/kernels/block_loops-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using VectorChange = std::array<double, ClusterLights::Stride>;

void add(const VectorChange& vector, VectorChange& sum) {
    constexpr std::size_t Last = ClusterLights::Stride - 1;
    const hn::CappedTag<double, Last> d;
    for (std::size_t lane = 0; lane < Last; lane += hn::Lanes(d))
        hn::StoreU(hn::Add(hn::LoadU(d, sum.data() + lane), hn::LoadU(d, vector.data() + lane)), d,
                   sum.data() + lane);
    sum[Last] += vector[Last];
}

/// Calls `visit` with each bit.
template<typename Visit>
HWY_INLINE void for_clusters(std::uint64_t bits, const Visit& visit) {
    for (; bits != 0; bits &= bits - 1)
        visit(bits & (~bits + 1));
}

/// Changed clusters of a block and word that add up per receiver.
struct ChangedPairs {
    std::size_t block;
    /// Seen whole, across a horizon.
    std::uint64_t across = 0;
    /// Seen in part.
    std::uint64_t mixed = 0;
    /// All clusters of the word that the block sees in part, and their counts.
    std::uint64_t all_mixed = 0;
    const std::uint8_t* counts = nullptr;

    [[nodiscard]] const std::uint8_t* counts_of(std::uint64_t cluster) const {
        return counts + num_counts(all_mixed & (cluster - 1));
    }
};

/// A channel's sums of some receivers in double: two vectors for one of Floats. (Where vectors have
/// one lane, both are the same.)
class DoubleSum {
    using D = hn::CappedTag<double, prt::BlockSize>;

public:
    explicit DoubleSum(const double* sum)
        : lower_(hn::LoadU(D(), sum)), upper_(hn::LoadU(D(), sum + begin_of_upper())) {}
    void store(double* sum) const {
        hn::StoreU(lower_, D(), sum);
        hn::StoreU(upper_, D(), sum + begin_of_upper());
    }

    /// Floats turned to double.
    struct Part {
        hn::Vec<D> lower, upper;

        explicit Part(hn::Vec<Floats> part) : lower(hn::Zero(D())), upper(lower) {
            const hn::Rebind<float, D> half;
            std::array<float, prt::BlockSize> values;
            hn::StoreU(part, Floats(), values.data());
            lower = hn::PromoteTo(D(), hn::LoadU(half, values.data()));
            upper = hn::PromoteTo(D(), hn::LoadU(half, values.data() + begin_of_upper()));
        }
    };
    void add(const Part& part, double factor) {
        const auto f = hn::Set(D(), factor);
        lower_ = hn::MulAdd(part.lower, f, lower_);
        upper_ = hn::MulAdd(part.upper, f, upper_);
    }

private:
    static std::size_t begin_of_upper() { return hn::Lanes(Floats()) - hn::Lanes(D()); }

    hn::Vec<D> lower_, upper_;
};

/// Adds the changes of a block's pairs to what adds up per receiver.
void change_pairs(const ChangedPairs& pairs, const BlockNormals& normals, const ChangedWord& change,
                  const LightChanges& changes, BlockLight& light) {
    const Floats d;
    const auto zero = hn::Zero(d);
    const auto full = hn::Set(d, static_cast<float>(prt::FullCount));
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
        const Normals<Floats> n(normals, lane);
        DoubleSum red(light.mixed[0].data() + lane);
        DoubleSum green(light.mixed[1].data() + lane);
        DoubleSum blue(light.mixed[2].data() + lane);
        for_clusters(pairs.across | pairs.mixed, [&](std::uint64_t cluster) {
            const auto count = (pairs.mixed & cluster) != 0
                                   ? load_counts(d, pairs.counts_of(cluster) + lane)
                                   : full;
            const std::size_t index = change.index_of(cluster);
            for (std::size_t i = changes.directionals_before[index];
                 i < changes.directionals_before[index + 1]; ++i) {
                const DirectionalChange& directional = changes.directionals[i];
                const auto cosine = hn::Max(n.dot(directional.direction.data()), zero);
                const DoubleSum::Part part(hn::Mul(count, cosine));
                red.add(part, directional.colour[0]);
                green.add(part, directional.colour[1]);
                blue.add(part, directional.colour[2]);
            }
        });
        red.store(light.mixed[0].data() + lane);
        green.store(light.mixed[1].data() + lane);
        blue.store(light.mixed[2].data() + lane);
    }
}

/// Updates the blocks of a tile, word by word. The time goes into memory: an update touches a few
/// lines of many pages. So words are asked for before their turn, and counts while the next word is
/// looked at.
class TileUpdate {
public:
    TileUpdate(const BlockScene& scene, std::size_t tile, const LightChanges& changes,
               BlockLight* light)
        : scene_(scene), changes_(changes), begin_(scene.counts.tile_begin(tile)),
          all_blocks_(scene.counts.tile_blocks(tile)),
          tile_words_(scene.words.words.data() + tile * scene.counts.words_per_block()),
          of_block_(light + begin_), normals_(scene.normals.data() + begin_) {
        whole_sums_.fill({});
    }

    /// Returns the blocks that see a changed cluster.
    std::uint64_t run() {
        for (std::size_t i = 0; i < changes_.words.size(); ++i) {
            const ChangedWord& change = changes_.words[i];
            if (i + 1 < changes_.words.size())
                ask_for(changes_.words[i + 1]);
            if (i + 2 < changes_.words.size())
                hwy::Prefetch(tile_words_ + changes_.words[i + 2].word);
            const TileWord& blocks = tile_words_[change.word];
            const std::uint64_t for_all = change.clusters & blocks.whole_for_all;
            if (for_all != 0) {
                add_whole(change, for_all, sum_of_all_);
                summed_ = all_blocks_;
            }
            const std::uint64_t rest = change.clusters & ~for_all;
            if ((rest & blocks.seen_by_some) != 0)
                add_seen(change, blocks, rest);
            if ((rest & blocks.mixed_for_some) != 0)
                add_mixed(change, blocks, rest);
        }
        for (Pending& word : pending_)
            finish(word);
        for_bits(summed_, [&](std::size_t block) {
            add(sum_of_all_, whole_sums_[block]);
            add(whole_sums_[block], of_block_[block].visible);
        });
        return paired_ | summed_;
    }

private:
    /// Pairs of a word whose counts are on their way from memory.
    struct Pending {
        const ChangedWord* change;
        std::size_t size = 0;
        std::array<ChangedPairs, prt::VisibleCounts::TileBlocks> pairs;
    };

    /// Asks for what add_seen() and add_mixed() will read. Inline, because g++ drops calls of a
    /// function that does nothing but ask for memory.
    HWY_INLINE void ask_for(const ChangedWord& change) const {
        const TileWord& blocks = tile_words_[change.word];
        const std::uint64_t rest = change.clusters & ~blocks.whole_for_all;
        const std::size_t word = scene_.counts.word(begin_, change.word);
        constexpr std::size_t WordsPerLine = 64 / sizeof(std::uint64_t);
        const auto ask = [&](const std::vector<std::uint64_t>& words) {
            const std::uint64_t* line = words.data() + word;
            for (std::uint64_t left = all_blocks_; left != 0;
                 left >>= WordsPerLine, line += WordsPerLine)
                hwy::Prefetch(line);
        };
        if ((rest & blocks.seen_by_some) != 0)
            ask(scene_.counts.visible);
        if ((rest & blocks.mixed_for_some) != 0)
            ask(scene_.counts.mixed);
    }

    /// Adds what changed clusters give to a block that sees them whole.
    HWY_INLINE void add_whole(const ChangedWord& change, std::uint64_t clusters,
                              VectorChange& sum) const {
        if (clusters == change.clusters)
            return add(change.vector, sum);
        for_clusters(clusters, [&](std::uint64_t cluster) {
            add(changes_.vectors[change.index_of(cluster)], sum);
        });
    }

    /// Adds those of `clusters` that a block sees whole.
    HWY_INLINE void add_seen(const ChangedWord& change, const TileWord& blocks,
                             std::uint64_t clusters) {
        // Most blocks that see one changed cluster whole see all of them, because these are
        // neighbours in the sky.
        VectorChange of_all_clusters{};
        add_whole(change, clusters, of_all_clusters);
        for_bits(blocks.full, [&](std::size_t block) { add(of_all_clusters, whole_sums_[block]); });
        summed_ |= blocks.full;
        const std::uint64_t* visible =
            scene_.counts.visible.data() + scene_.counts.word(begin_, change.word);
        for_bits((blocks.visible | blocks.across) & ~blocks.full, [&](std::size_t block) {
            const std::uint64_t seen = visible[block] & clusters;
            if (seen == 0)
                return;
            const std::uint64_t across = scene_.words.across_of(blocks, block) & seen;
            if (across != 0)
                add_pairs({.block = block, .across = across}, change);
            const std::uint64_t whole = seen & ~across;
            if (whole == clusters)
                add(of_all_clusters, whole_sums_[block]);
            else
                add_whole(change, whole, whole_sums_[block]);
            summed_ |= std::uint64_t{whole != 0} << block;
        });
    }

    /// Adds those of `clusters` that a block sees in part, once the next word has been looked at.
    HWY_INLINE void add_mixed(const ChangedWord& change, const TileWord& blocks,
                              std::uint64_t clusters) {
        Pending& word = pending_[next_pending_];
        next_pending_ ^= 1u;
        finish(word);
        word.change = &change;
        const std::uint64_t* mixed =
            scene_.counts.mixed.data() + scene_.counts.word(begin_, change.word);
        const std::uint8_t* counts =
            scene_.counts.counts.data() + blocks.mixed_before * prt::BlockSize;
        for_bits(blocks.mixed, [&](std::size_t block) {
            const ChangedPairs pairs{.block = block,
                                     .mixed = mixed[block] & clusters,
                                     .all_mixed = mixed[block],
                                     .counts = counts};
            counts += num_counts(pairs.all_mixed);
            if (pairs.mixed == 0)
                return;
            for_clusters(pairs.mixed,
                         [&](std::uint64_t cluster) { hwy::Prefetch(pairs.counts_of(cluster)); });
            word.pairs[word.size++] = pairs;
        });
    }

    void add_pairs(const ChangedPairs& pairs, const ChangedWord& change) {
        change_pairs(pairs, normals_[pairs.block], change, changes_, of_block_[pairs.block]);
        paired_ |= std::uint64_t{1} << pairs.block;
    }

    void finish(Pending& word) {
        for (std::size_t i = 0; i < word.size; ++i)
            add_pairs(word.pairs[i], *word.change);
        word.size = 0;
    }

    const BlockScene& scene_;
    const LightChanges& changes_;
    std::size_t begin_;
    std::uint64_t all_blocks_;
    const TileWord* tile_words_;
    // The tile's first:
    BlockLight* of_block_;
    const BlockNormals* normals_;
    // Side by side, because BlockLights are too far apart for the nearest cache.
    std::array<VectorChange, prt::VisibleCounts::TileBlocks> whole_sums_;
    /// The change by clusters that all blocks see whole.
    VectorChange sum_of_all_{};
    /// Blocks that have such sums, and pairs.
    std::uint64_t summed_ = 0, paired_ = 0;
    std::array<Pending, 2> pending_;
    std::size_t next_pending_ = 0;
};

std::uint64_t update_tile(const BlockScene& scene, std::size_t tile, const LightChanges& changes,
                          BlockLight* light) {
    return TileUpdate(scene, tile, changes, light).run();
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

namespace {
HWY_EXPORT(update_tile);
} // namespace

std::uint64_t update_tile(const BlockScene& scene, std::size_t tile, const LightChanges& changes,
                          std::span<BlockLight> light) {
    return HWY_DYNAMIC_DISPATCH(update_tile)(scene, tile, changes, light.data());
}

} // namespace relumine::relight
#endif // HWY_ONCE
