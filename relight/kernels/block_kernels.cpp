#include "relight/kernels/block_kernels.h"

#include <cmath>

#include "prt/clusters/lattice.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/kernels/block_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "relight/kernels/block_loops-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Receivers of a block that are summed side by side, so that each cluster is read and decided
/// about once for them: two vectors of them where one does not hold the block.
struct SideBySide {
    static constexpr std::size_t NumVectors = hn::MaxLanes(Floats()) < prt::BlockSize ? 2 : 1;
    static constexpr std::size_t Size = NumVectors * hn::MaxLanes(Floats());
};

/// Adds max(n.E, 0) of clusters.
template<bool AnySpread>
HWY_INLINE void add_whole(std::uint64_t bits, const Normals<Floats>* normals,
                          const WordLights& lights, Sum* sums) {
    for (; bits != 0; bits &= bits - 1)
        for (std::size_t v = 0; v < SideBySide::NumVectors; ++v)
            add_cluster<AnySpread>(lights, first_bit(bits), normals[v], sums[v]);
}

/// Adds c max(n.E, 0) of clusters.
template<bool AnySpread>
HWY_INLINE void add_counted(std::uint64_t bits, const std::uint8_t* counts,
                            const Normals<Floats>* normals, const WordLights& lights, Sum* sums) {
    const Floats d;
    const auto zero = hn::Zero(d);
    for (; bits != 0; bits &= bits - 1, counts += prt::BlockSize) {
        const std::size_t i = first_bit(bits);
        for (std::size_t v = 0; v < SideBySide::NumVectors; ++v) {
            const Normals<Floats>& n = normals[v];
            Sum& sum = sums[v];
            const auto count = load_counts(d, counts + v * hn::Lanes(d));
            if (AnySpread && (lights.spread >> i & 1u) != 0) {
                const float* e = lights.vectors + i * ClusterLights::Stride;
                sum.red = hn::MulAdd(count, hn::Max(n.dot(e), zero), sum.red);
                sum.green = hn::MulAdd(count, hn::Max(n.dot(e + 3), zero), sum.green);
                sum.blue = hn::MulAdd(count, hn::Max(n.dot(e + 6), zero), sum.blue);
            } else {
                const float* directional =
                    lights.directionals + i * ClusterLights::DirectionalStride;
                sum.add(hn::Mul(count, hn::Max(n.dot(directional), zero)), directional + 3);
            }
        }
    }
}

/// Adds the clusters of a block and word that add up per receiver.
template<bool AnySpread>
void add_pairs(const Pairs& pairs, const BlockNormals& normals, const WordLights& lights,
               FloatSum& result) {
    const Floats d;
    constexpr std::size_t Last = SideBySide::NumVectors - 1;
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += SideBySide::Size) {
        const std::size_t last = lane + Last * hn::Lanes(d);
        const Normals<Floats> n[] = {{normals, lane}, {normals, last}};
        Sum sums[] = {{result, lane}, {result, last}};
        if (pairs.across != 0) {
            Sum whole[2];
            add_whole<AnySpread>(pairs.across, n, lights, whole);
            const auto full = hn::Set(d, static_cast<float>(prt::FullCount));
            for (std::size_t v = 0; v < SideBySide::NumVectors; ++v) {
                sums[v].red = hn::MulAdd(full, whole[v].red, sums[v].red);
                sums[v].green = hn::MulAdd(full, whole[v].green, sums[v].green);
                sums[v].blue = hn::MulAdd(full, whole[v].blue, sums[v].blue);
            }
        }
        add_counted<AnySpread>(pairs.mixed, pairs.counts + lane, n, lights, sums);
        for (std::size_t v = 0; v < SideBySide::NumVectors; ++v)
            sums[v].store(result, lane + v * hn::Lanes(d));
    }
}

/// Sums the clusters of runs: a sum of all clusters before each run's end, minus a sum of those
/// before its beginning. `prefix` begins at the word's first cluster.
void add_runs(const Runs& runs, const double* prefix, double* sum) {
    constexpr std::size_t Last = ClusterLights::Stride - 1;
    constexpr std::array<double, 2> Signs = {1.0, -1.0};
    const hn::CappedTag<double, Last> d;
    double last = sum[Last];
    for (std::size_t lane = 0; lane < Last; lane += hn::Lanes(d)) {
        auto lanes = hn::LoadU(d, sum + lane);
        for (std::uint64_t bits = runs.edges; bits != 0; bits &= bits - 1) {
            const std::size_t i = first_bit(bits);
            const double sign = Signs[runs.visible >> i & 1u];
            const double* before = prefix + i * ClusterLights::Stride;
            lanes = hn::MulAdd(hn::Set(d, sign), hn::LoadU(d, before + lane), lanes);
            if (lane == 0)
                last += sign * before[Last];
        }
        hn::StoreU(lanes, d, sum + lane);
    }
    sum[Last] = last;
}

double block_radiance(const BlockNormals& normals, const BlockLight& light,
                      const TracedRadiance* traced, BlockRadiance& radiance) {
    const hn::CappedTag<double, 8> doubles;
    const hn::Rebind<float, decltype(doubles)> d;
    constexpr std::size_t Last = ClusterLights::Stride - 1;
    const auto full = static_cast<double>(prt::FullCount);
    std::array<float, ClusterLights::Stride> visible;
    visible[Last] = static_cast<float>(full * light.visible[Last]);
    auto largest = hn::Set(d, std::abs(visible[Last]));
    for (std::size_t lane = 0; lane < Last; lane += hn::Lanes(d)) {
        const auto part = hn::DemoteTo(
            d, hn::Mul(hn::Set(doubles, full), hn::LoadU(doubles, light.visible.data() + lane)));
        hn::StoreU(part, d, visible.data() + lane);
        largest = hn::Max(largest, hn::Abs(part));
    }
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
        const Normals<decltype(d)> n(normals, lane);
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const auto mixed =
                hn::DemoteTo(d, hn::LoadU(doubles, light.mixed[channel].data() + lane));
            largest = hn::Max(largest, hn::Abs(mixed));
            // A sum of nothing may round to a hair below zero.
            auto sum = hn::Max(hn::Zero(d), hn::Add(n.dot(visible.data() + 3 * channel), mixed));
            if (traced != nullptr)
                sum = hn::Add(
                    sum,
                    hn::DemoteTo(d, hn::LoadU(doubles, traced->channels[channel].data() + lane)));
            hn::StoreU(sum, d, radiance.channels[channel].data() + lane);
        }
    }
    return static_cast<double>(hn::GetLane(hn::MaxOfLanes(d, largest)));
}

/// Adds up the clusters that the chosen blocks of a tile see whole.
void add_visible(const BlockScene& scene, std::size_t tile, const ClusterLights& lights,
                 std::uint64_t chosen, BlockLight* of_block) {
    // Side by side, because BlockLights are too far apart for the nearest cache.
    using Vector = std::array<double, ClusterLights::Stride>;
    std::array<Vector, prt::VisibleCounts::TileBlocks> sums{};
    const double* prefix = lights.prefix.data();
    OpenRuns open;
    for (std::size_t w = 0; w < scene.counts.words_per_block(); ++w) {
        for_runs(scene, tile, w, chosen, open, [&](std::size_t block, const Runs& runs) {
            add_runs(runs, prefix, sums[block].data());
        });
        prefix += 64 * ClusterLights::Stride;
    }
    for_bits(chosen, [&](std::size_t block) {
        add_runs(open.last(block), prefix, sums[block].data());
        of_block[block].visible = sums[block];
    });
}

/// Adds up the clusters that the chosen blocks of a tile see in part or across a horizon.
void add_per_receiver(const BlockScene& scene, std::size_t tile, const ClusterLights& lights,
                      std::uint64_t chosen, BlockLight* of_block) {
    const BlockNormals* normals = scene.normals.data() + scene.counts.tile_begin(tile);
    const std::size_t num_words = scene.counts.words_per_block();
    std::array<FloatSum, prt::VisibleCounts::TileBlocks> sums{};
    FloatWords<8> in_float;
    for (std::size_t w = 0; w < num_words; ++w) {
        const WordLights of_word(lights, w);
        const std::uint64_t lit =
            for_pairs(scene, tile, w, chosen, [&](std::size_t block, const Pairs& pairs) {
                if (((pairs.mixed | pairs.across) & of_word.spread) != 0)
                    add_pairs<true>(pairs, normals[block], of_word, sums[block]);
                else
                    add_pairs<false>(pairs, normals[block], of_word, sums[block]);
            });
        in_float.after(w, num_words, lit, [&](std::size_t block) {
            add(sums[block], of_block[block]);
            sums[block] = {};
        });
    }
}

void light_tile(const BlockScene& scene, std::size_t tile, const ClusterLights& lights,
                BlockLight* light, std::uint64_t chosen) {
    const std::size_t begin = scene.counts.tile_begin(tile);
    chosen &= scene.counts.tile_blocks(tile);
    for_bits(chosen, [&](std::size_t block) { light[begin + block] = {}; });
    add_visible(scene, tile, lights, chosen, light + begin);
    add_per_receiver(scene, tile, lights, chosen, light + begin);
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

namespace {
HWY_EXPORT(block_radiance);
HWY_EXPORT(light_tile);
} // namespace

double block_radiance(const BlockNormals& normals, const BlockLight& light,
                      const TracedRadiance* traced, BlockRadiance& radiance) {
    return HWY_DYNAMIC_DISPATCH(block_radiance)(normals, light, traced, radiance);
}

void light_tile(const BlockScene& scene, std::size_t tile, const ClusterLights& lights,
                std::span<BlockLight> light, std::uint64_t blocks) {
    HWY_DYNAMIC_DISPATCH(light_tile)(scene, tile, lights, light.data(), blocks);
}

} // namespace relumine::relight
#endif // HWY_ONCE
