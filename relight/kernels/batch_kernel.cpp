#include "relight/kernels/batch_kernel.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "prt/clusters/lattice.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/kernels/batch_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "files/parallel.h"
#include "relight/kernels/block_loops-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace {

constexpr std::size_t TileBlocks = prt::VisibleCounts::TileBlocks;
/// Environments whose sums are in registers at the same time.
constexpr std::size_t Side = 4;
static_assert(BatchLights::Most % Side == 0);

/// The clusters of a word that a block sees in part or across a horizon, decoded once for all
/// environments.
class WordPairs {
public:
    void clear() { num_common_ = num_own_ = 0; }

    void add(const Pairs& pairs, const BlockNormals& normals, const BatchLights& lights,
             std::size_t w) {
        const std::uint64_t clusters = pairs.mixed | pairs.across, common = lights.common[w];
        if ((clusters & common) != 0)
            add_weights(clusters & common, pairs, normals, lights.directions.data() + w * 64 * 3,
                        lights.leaders.data() + w * 64);
        if ((clusters & ~common) != 0)
            add_normals(clusters & ~common, pairs, normals);
    }

    /// Adds all of them for environments side by side.
    HWY_INLINE void light(const std::array<WordLights, Side>& lights, FloatSum* sums) const {
        const Floats d;
        for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
            Sum a(sums[0], lane), b(sums[1], lane), c(sums[2], lane), e(sums[3], lane);
            for (std::size_t pair = 0; pair < num_common_; ++pair) {
                const auto weight = hn::Load(d, weights_[pair].data() + lane);
                const std::size_t colour =
                    std::size_t{common_[pair]} * ClusterLights::DirectionalStride + 3;
                a.add(weight, lights[0].directionals + colour);
                b.add(weight, lights[1].directionals + colour);
                c.add(weight, lights[2].directionals + colour);
                e.add(weight, lights[3].directionals + colour);
            }
            if (num_own_ != 0) {
                add_own(lights[0], lane, a);
                add_own(lights[1], lane, b);
                add_own(lights[2], lane, c);
                add_own(lights[3], lane, e);
            }
            a.store(sums[0], lane);
            b.store(sums[1], lane);
            c.store(sums[2], lane);
            e.store(sums[3], lane);
        }
    }

private:
    /// Where a cluster's counts are; 16 for those that are seen whole.
    static HWY_INLINE const std::uint8_t* counts_of(std::size_t cluster, const Pairs& pairs) {
        static constexpr auto Whole = [] {
            std::array<std::uint8_t, prt::BlockSize> all{};
            all.fill(prt::FullCount);
            return all;
        }();
        return (pairs.mixed >> cluster & 1u) != 0 ? pairs.counts_of(cluster) : Whole.data();
    }
    /// Without branches, which nobody could foresee.
    HWY_INLINE void add_weights(std::uint64_t bits, const Pairs& pairs, const BlockNormals& normals,
                                const float* directions, const std::uint8_t* leaders) {
        const Floats d;
        for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
            const Normals<Floats> n(normals, lane);
            auto sum = hn::Zero(d);
            num_common_ = 0;
            std::uint8_t last = 64; // no cluster's bit
            for (std::uint64_t rest = bits; rest != 0; rest &= rest - 1) {
                const std::size_t i = first_bit(rest);
                const auto count = load_counts(d, counts_of(i, pairs) + lane);
                const auto cosine = hn::Max(n.dot(directions + i * 3), hn::Zero(d));
                const bool goes_on = leaders[i] == last;
                last = leaders[i];
                num_common_ += goes_on ? 0 : 1;
                common_[num_common_ - 1] = last;
                sum = hn::MulAdd(count, cosine, hn::Mul(sum, hn::Set(d, goes_on ? 1.0f : 0.0f)));
                hn::Store(sum, d, weights_[num_common_ - 1].data() + lane);
            }
        }
    }
    HWY_INLINE void add_normals(std::uint64_t bits, const Pairs& pairs,
                                const BlockNormals& normals) {
        const Floats d;
        for (; bits != 0; bits &= bits - 1) {
            const std::size_t i = first_bit(bits);
            own_[num_own_] = static_cast<std::uint8_t>(i);
            BlockNormals& result = normals_[num_own_++];
            for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
                const Normals<Floats> n(normals, lane);
                const auto count = load_counts(d, counts_of(i, pairs) + lane);
                hn::Store(hn::Mul(count, n.x), d, result.axes[0].data() + lane);
                hn::Store(hn::Mul(count, n.y), d, result.axes[1].data() + lane);
                hn::Store(hn::Mul(count, n.z), d, result.axes[2].data() + lane);
            }
        }
    }

    /// Adds the clusters whose direction is each environment's own.
    HWY_INLINE void add_own(const WordLights& lights, std::size_t lane, Sum& sum) const {
        for (std::size_t pair = 0; pair < num_own_; ++pair)
            add_cluster<true>(lights, own_[pair], Normals<Floats>(normals_[pair], lane), sum);
    }

    std::size_t num_common_ = 0, num_own_ = 0;
    /// Bits of the clusters whose light each entry has.
    std::array<std::uint8_t, 64> common_, own_;
    /// Counts times cosines.
    alignas(64) std::array<std::array<float, prt::BlockSize>, 64> weights_;
    /// Count times normal.
    std::array<BlockNormals, 64> normals_;
};

/// Adds up the clusters that the blocks of a tile see in part or across a horizon.
void add_per_receiver(const BlockScene& scene, std::size_t tile, const BatchLights& lights,
                      BlockLight* light) {
    constexpr std::size_t Most = BatchLights::Most;
    const BlockNormals* normals = scene.normals.data() + scene.counts.tile_begin(tile);
    const std::size_t num_words = scene.counts.words_per_block();
    std::array<std::array<FloatSum, Most>, TileBlocks> sums{};
    FloatWords<16> in_float;
    WordPairs decoded;
    for (std::size_t w = 0; w < num_words; ++w) {
        std::array<WordLights, Most> of_word;
        for (std::size_t k = 0; k < Most; ++k)
            of_word[k] = WordLights(lights.each[k], w);
        const std::uint64_t lit = for_pairs(
            scene, tile, w, ~std::uint64_t{0}, [&](std::size_t block, const Pairs& pairs) {
                decoded.clear();
                decoded.add(pairs, normals[block], lights, w);
                for (std::size_t k = 0; k < lights.size; k += Side)
                    decoded.light({of_word[k], of_word[k + 1], of_word[k + 2], of_word[k + 3]},
                                  sums[block].data() + k);
            });
        in_float.after(w, num_words, lit, [&](std::size_t block) {
            for (std::size_t k = 0; k < lights.size; ++k)
                add(sums[block][k], light[k * TileBlocks + block]);
            sums[block] = {};
        });
    }
}

using Vectors = std::array<BatchLights::Numbers, ClusterLights::Stride>;

/// Sums the clusters of runs, as with one environment.
void add_runs(const Runs& runs, const BatchLights::Numbers* prefix, Vectors& result) {
    const hn::CappedTag<double, 8> d;
    for (std::size_t lane = 0; lane < BatchLights::Most; lane += hn::Lanes(d)) {
        const auto load = [&](const BatchLights::Numbers& numbers) HWY_ATTR {
            return hn::Load(d, numbers.of.data() + lane);
        };
        auto xr = load(result[0]), yr = load(result[1]), zr = load(result[2]);
        auto xg = load(result[3]), yg = load(result[4]), zg = load(result[5]);
        auto xb = load(result[6]), yb = load(result[7]), zb = load(result[8]);
        for (std::uint64_t bits = runs.edges; bits != 0; bits &= bits - 1) {
            const std::size_t i = first_bit(bits);
            const auto sign = hn::Set(d, (runs.visible >> i & 1u) != 0 ? -1.0 : 1.0);
            const BatchLights::Numbers* before = prefix + i * ClusterLights::Stride;
            xr = hn::MulAdd(sign, load(before[0]), xr);
            yr = hn::MulAdd(sign, load(before[1]), yr);
            zr = hn::MulAdd(sign, load(before[2]), zr);
            xg = hn::MulAdd(sign, load(before[3]), xg);
            yg = hn::MulAdd(sign, load(before[4]), yg);
            zg = hn::MulAdd(sign, load(before[5]), zg);
            xb = hn::MulAdd(sign, load(before[6]), xb);
            yb = hn::MulAdd(sign, load(before[7]), yb);
            zb = hn::MulAdd(sign, load(before[8]), zb);
        }
        const auto store = [&](hn::Vec<decltype(d)> sum, BatchLights::Numbers& numbers) HWY_ATTR {
            hn::Store(sum, d, numbers.of.data() + lane);
        };
        store(xr, result[0]), store(yr, result[1]), store(zr, result[2]);
        store(xg, result[3]), store(yg, result[4]), store(zg, result[5]);
        store(xb, result[6]), store(yb, result[7]), store(zb, result[8]);
    }
}

/// Adds up the clusters that the blocks of a tile see whole.
void add_visible(const BlockScene& scene, std::size_t tile, const BatchLights& lights,
                 BlockLight* light) {
    std::array<Vectors, TileBlocks> sums{};
    const BatchLights::Numbers* prefix = lights.prefix.data();
    const std::uint64_t all = scene.counts.tile_blocks(tile);
    OpenRuns open;
    for (std::size_t w = 0; w < scene.counts.words_per_block(); ++w) {
        for_runs(scene, tile, w, all, open,
                 [&](std::size_t block, const Runs& runs) { add_runs(runs, prefix, sums[block]); });
        prefix += 64 * ClusterLights::Stride;
    }
    for_bits(all, [&](std::size_t block) {
        add_runs(open.last(block), prefix, sums[block]);
        for (std::size_t k = 0; k < lights.size; ++k)
            for (std::size_t i = 0; i < ClusterLights::Stride; ++i)
                light[k * TileBlocks + block].visible[i] = sums[block][i].of[k];
    });
}

} // namespace

void light_batch_tile(const BlockScene& scene, std::size_t tile, const BatchLights& lights,
                      BlockLight* light) {
    std::fill_n(light, lights.size * TileBlocks, BlockLight());
    add_visible(scene, tile, lights, light);
    add_per_receiver(scene, tile, lights, light);
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

namespace {

HWY_EXPORT(light_batch_tile);

/// Sets `direction` to that of a cluster in all environments that light it. Returns whether these
/// have the same one.
bool have_common_direction(std::span<const ClusterLights> lights, std::size_t cluster,
                           float* direction) {
    bool any = false;
    for (const ClusterLights& light : lights) {
        if (light.is_spread(cluster))
            return false;
        const float* own = light.directionals.data() + cluster * ClusterLights::DirectionalStride;
        if (own[3] == 0.0f && own[4] == 0.0f && own[5] == 0.0f)
            continue;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (!any)
                direction[axis] = own[axis];
            else if (std::abs(own[axis] - direction[axis]) > BatchLights::Roundings)
                return false;
        }
        any = true;
    }
    return true;
}

/// Sets `ratio` to how much brighter a cluster is than another one. Returns whether all lights,
/// none of which are spread there, say the same for all channels.
bool have_common_ratio(std::span<const ClusterLights> lights, std::size_t cluster,
                       std::size_t other, float& ratio) {
    bool any = false;
    for (const ClusterLights& light : lights) {
        const auto colour = [&](std::size_t of) {
            const float* c = light.directionals.data() + of * ClusterLights::DirectionalStride + 3;
            return glm::vec3(c[0], c[1], c[2]);
        };
        const glm::vec3 here = colour(cluster), there = colour(other);
        const float brightest = std::max({there.r, there.g, there.b});
        if (!any && brightest > 0.0f) {
            any = true;
            ratio = glm::dot(here, there) / glm::dot(there, there);
        }
        const glm::vec3 off = glm::abs(here - ratio * there);
        if (std::max({off.r, off.g, off.b}) > BatchLights::Roundings * brightest)
            return false;
    }
    return any;
}

} // namespace

BatchLights::BatchLights(std::size_t num_clusters)
    : each(Most, ClusterLights(num_clusters)), common((num_clusters + 63) / 64),
      directions(num_clusters * 3), leaders(num_clusters),
      prefix((common.size() * 64 + 1) * ClusterLights::Stride) {}

void BatchLights::compare_and_sum() {
    const std::size_t num_clusters = directions.size() / 3;
    const std::span<const ClusterLights> lit = std::span(each).first(size);
    files::parallel_for(std::size_t{0}, common.size(), [&](std::size_t word) {
        common[word] = 0;
        const std::size_t begin = word * 64, end = std::min(begin + 64, num_clusters);
        std::size_t leader = end; // none
        for (std::size_t cluster = begin; cluster < end; ++cluster) {
            float* direction = directions.data() + cluster * 3;
            if (!have_common_direction(lit, cluster, direction)) {
                leader = end;
                continue;
            }
            common[word] |= std::uint64_t{1} << (cluster - begin);
            float ratio = 1.0f;
            if (leader == end || !have_common_ratio(lit, cluster, leader, ratio)) {
                leader = cluster;
                ratio = 1.0f;
            }
            leaders[cluster] = static_cast<std::uint8_t>(leader - begin);
            for (std::size_t axis = 0; axis < 3; ++axis)
                direction[axis] *= ratio;
        }
    });
    constexpr std::size_t Stride = ClusterLights::Stride;
    files::parallel_for(std::size_t{0}, Stride, [&](std::size_t i) {
        for (std::size_t at = i; at < num_clusters * Stride; at += Stride)
            for (std::size_t k = 0; k < Most; ++k)
                prefix[at + Stride].of[k] =
                    prefix[at].of[k] + static_cast<double>(each[k].vectors[at]);
    });
}

void light_tile(const BlockScene& scene, std::size_t tile, const BatchLights& lights,
                std::span<BlockLight> light) {
    HWY_DYNAMIC_DISPATCH(light_batch_tile)(scene, tile, lights, light.data());
}

} // namespace relumine::relight
#endif // HWY_ONCE
