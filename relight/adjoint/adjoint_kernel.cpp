#include "relight/adjoint/adjoint_kernel.h"

#include <bit>

#include "prt/clusters/lattice.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/adjoint/adjoint_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, prt::BlockSize>;

/// Sums of float for a word's clusters, [cluster][channel x axis][lane]. The lanes are added up at
/// the end: so vectors of any width give the same bits.
using LaneSums = std::array<std::array<std::array<float, prt::BlockSize>, BlockWeights::Size>, 64>;

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

/// Adds one pair of block and cluster. Null `counts`: the block sees all of the cluster.
template<bool ChannelsDiffer>
HWY_INLINE void add_pair(const std::uint8_t* counts, const BlockNormals& normals,
                         const BlockWeights& weights, const float* gates,
                         std::array<std::array<float, prt::BlockSize>, BlockWeights::Size>& sums) {
    const Floats d;
    const hn::Rebind<std::uint8_t, Floats> bytes;
    const hn::Rebind<std::int32_t, Floats> integers;
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
        auto count = hn::Set(d, static_cast<float>(prt::FullCount));
        if (counts != nullptr)
            count = hn::ConvertTo(d, hn::PromoteTo(integers, hn::LoadU(bytes, counts + lane)));
        auto inside = hn::IfThenElseZero(is_above(normals, lane, gates), count);
        for (std::size_t channel = 0; channel < 3; ++channel) {
            if (ChannelsDiffer && channel > 0)
                inside = hn::IfThenElseZero(is_above(normals, lane, gates + 3 * channel), count);
            for (std::size_t i = 3 * channel; i < 3 * channel + 3; ++i) {
                const auto product = hn::LoadU(d, weights.products[i].data() + lane);
                float* sum = sums[i].data() + lane;
                hn::StoreU(hn::MulAdd(inside, product, hn::LoadU(d, sum)), d, sum);
            }
        }
    }
}

/// Adds the runs of clusters that blocks see whole: where one begins, and where it has ended.
/// `inside` has the blocks that see the word before up to its end.
void add_runs(const BlockScene& scene, const TileWord& blocks, const std::uint64_t* visible_words,
              const BlockWeights* weights, std::uint64_t& inside, ClusterWeights::Sums* steps,
              std::size_t num_clusters) {
    for_bits(blocks.edges, [&](std::size_t block) {
        const std::uint64_t visible = visible_words[block] & ~scene.words.across_of(blocks, block);
        const ClusterWeights::Sums& whole = weights[block].whole;
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

/// Adds the pairs of a tile and a word that the kernel of lighting adds per receiver.
void add_pairs(const BlockScene& scene, std::size_t tile, std::size_t w, const Gates& gates,
               const BlockWeights* weights, LaneSums& lanes, ClusterWeights::Sums* sums) {
    const prt::VisibleCounts& counts = scene.counts;
    const std::size_t begin = counts.tile_begin(tile);
    const TileWord& blocks = scene.words.words[tile * counts.words_per_block() + w];
    const std::uint64_t* mixed_words = counts.mixed.data() + counts.word(begin, w);
    const std::uint8_t* of_pairs = counts.counts.data() + blocks.mixed_before * prt::BlockSize;
    const float* gates_of_word = gates.vectors.data() + w * 64 * BlockWeights::Size;
    const std::uint64_t differ = gates.differ[w];
    std::uint64_t added = 0;
    for_bits(blocks.mixed | blocks.across, [&](std::size_t block) {
        const BlockNormals& normals = scene.normals[begin + block];
        const auto add = [&](std::size_t cluster, const std::uint8_t* pair) {
            const float* gate = gates_of_word + cluster * BlockWeights::Size;
            if ((differ >> cluster & 1u) != 0)
                add_pair<true>(pair, normals, weights[block], gate, lanes[cluster]);
            else
                add_pair<false>(pair, normals, weights[block], gate, lanes[cluster]);
        };
        const std::uint64_t across = scene.words.across_of(blocks, block);
        const std::uint64_t mixed = mixed_words[block];
        for_bits(across, [&](std::size_t cluster) { add(cluster, nullptr); });
        for_bits(mixed, [&](std::size_t cluster) {
            add(cluster, of_pairs);
            of_pairs += prt::BlockSize;
        });
        added |= across | mixed;
    });
    for_bits(added, [&](std::size_t cluster) {
        for (std::size_t i = 0; i < BlockWeights::Size; ++i) {
            double sum = 0.0;
            for (const float lane : lanes[cluster][i])
                sum += static_cast<double>(lane);
            sums[cluster][i] += sum;
        }
        lanes[cluster] = {};
    });
}

void add_tile(const BlockScene& scene, std::size_t tile, std::size_t first_word,
              std::size_t last_word, const Gates& gates, const BlockWeights* weights,
              ClusterWeights& sums) {
    const prt::VisibleCounts& counts = scene.counts;
    const std::size_t begin = counts.tile_begin(tile);
    alignas(64) LaneSums lanes{};
    std::uint64_t inside = first_word > 0 ? inside_after(scene, tile, first_word - 1) : 0;
    for (std::size_t w = first_word; w < last_word; ++w) {
        add_runs(scene, scene.words.words[tile * counts.words_per_block() + w],
                 counts.visible.data() + counts.word(begin, w), weights + begin, inside,
                 sums.whole_steps.data() + w * 64, counts.num_leaves - w * 64);
        add_pairs(scene, tile, w, gates, weights + begin, lanes, sums.gated.data() + w * 64);
    }
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

namespace {
HWY_EXPORT(add_tile);
} // namespace

void add_tile(const BlockScene& scene, std::size_t tile, std::size_t first_word,
              std::size_t last_word, const Gates& gates, std::span<const BlockWeights> weights,
              ClusterWeights& sums) {
    HWY_DYNAMIC_DISPATCH(add_tile)
    (scene, tile, first_word, last_word, gates, weights.data(), sums);
}

std::vector<BlockWeights> block_weights(std::span<const glm::vec3> weights,
                                        std::span<const glm::vec3> normals) {
    std::vector<BlockWeights> blocks((weights.size() + prt::BlockSize - 1) / prt::BlockSize);
    for (std::size_t place = 0; place < weights.size(); ++place)
        for (int channel = 0; channel < 3; ++channel)
            for (int axis = 0; axis < 3; ++axis) {
                BlockWeights& block = blocks[place / prt::BlockSize];
                const auto i = static_cast<std::size_t>(3 * channel + axis);
                const float product = weights[place][channel] * normals[place][axis];
                block.products[i][place % prt::BlockSize] = product;
                block.whole[i] += static_cast<double>(prt::FullCount) *
                                  static_cast<double>(weights[place][channel]) *
                                  static_cast<double>(normals[place][axis]);
            }
    return blocks;
}

} // namespace relumine::relight
#endif // HWY_ONCE
