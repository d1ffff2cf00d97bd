#include "relight/block_kernels.h"

#include <algorithm>
#include <bit>
#include <numbers>

#include "prt/lattice.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/block_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Radiance of the 16 receivers from the mixed clusters of one word, [channel][receiver].
using WordSum = std::array<std::array<float, prt::BlockSize>, 3>;

using Floats = hn::CappedTag<float, prt::BlockSize>;
using FloatVec = hn::Vec<Floats>;

/// Normals of some of a block's receivers.
struct Normals {
    FloatVec x, y, z;

    Normals(const BlockNormals& normals, std::size_t lane)
        : x(hn::LoadU(Floats(), normals.axes[0].data() + lane)),
          y(hn::LoadU(Floats(), normals.axes[1].data() + lane)),
          z(hn::LoadU(Floats(), normals.axes[2].data() + lane)) {}

    /// max(n.e, 0)
    [[nodiscard]] FloatVec cosine(const float* e) const {
        const Floats d;
        const auto along_z = hn::Mul(z, hn::Set(d, e[2]));
        const auto n_dot_e = hn::MulAdd(x, hn::Set(d, e[0]), hn::MulAdd(y, hn::Set(d, e[1]), along_z));
        return hn::Max(n_dot_e, hn::Zero(d));
    }
};

FloatVec load_counts(const std::uint8_t* counts) {
    const Floats d;
    const hn::Rebind<std::uint8_t, Floats> bytes;
    const hn::Rebind<std::int32_t, Floats> integers;
    return hn::ConvertTo(d, hn::PromoteTo(integers, hn::LoadU(bytes, counts)));
}

/// c max(n.E, 0) added up over clusters, per channel.
struct Sum {
    FloatVec red, green, blue;

    // Written out: g++ compiles an implicit constructor without the instruction set of the functions around it.
    Sum() : red(hn::Zero(Floats())), green(red), blue(red) {}

    void add(FloatVec count, const Normals& n, const float* e) {
        add(count, n.cosine(e), n.cosine(e + 3), n.cosine(e + 6));
    }

    void add(FloatVec count, FloatVec r, FloatVec g, FloatVec b) {
        red = hn::MulAdd(count, r, red);
        green = hn::MulAdd(count, g, green);
        blue = hn::MulAdd(count, b, blue);
    }

    void store(WordSum& sum, std::size_t lane) const {
        hn::StoreU(red, Floats(), sum[0].data() + lane);
        hn::StoreU(green, Floats(), sum[1].data() + lane);
        hn::StoreU(blue, Floats(), sum[2].data() + lane);
    }
};

/// Sums c max(n.E, 0) over the set bits of `mixed`; `counts` and `vectors` begin at the word's first entry and cluster.
void sum_word(std::uint64_t mixed, const std::uint8_t* counts, const BlockNormals& normals,
              const float* vectors, WordSum& result) {
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(Floats())) {
        const Normals n(normals, lane);
        Sum sum;
        const std::uint8_t* entry = counts + lane;
        for (std::uint64_t bits = mixed; bits != 0; bits &= bits - 1, entry += prt::BlockSize)
            sum.add(load_counts(entry), n,
                    vectors + static_cast<std::size_t>(std::countr_zero(bits)) * ClusterLights::Stride);
        sum.store(result, lane);
    }
}

/// The same sum with two sets of vectors at once, which differ in `changed` clusters only.
void sum_word_twice(std::uint64_t mixed, std::uint64_t changed, const std::uint8_t* counts,
                    const BlockNormals& normals, const float* before, const float* after,
                    WordSum& result_before, WordSum& result_after) {
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(Floats())) {
        const Normals n(normals, lane);
        Sum sum_before;
        Sum sum_after;
        const std::uint8_t* entry = counts + lane;
        for (std::uint64_t bits = mixed; bits != 0; bits &= bits - 1, entry += prt::BlockSize) {
            const std::size_t first =
                static_cast<std::size_t>(std::countr_zero(bits)) * ClusterLights::Stride;
            const auto count = load_counts(entry);
            const float* e = before + first;
            const auto red = n.cosine(e), green = n.cosine(e + 3), blue = n.cosine(e + 6);
            sum_before.add(count, red, green, blue);
            if ((changed & bits & (~bits + 1)) == 0)
                sum_after.add(count, red, green, blue);
            else
                sum_after.add(count, n, after + first);
        }
        sum_before.store(result_before, lane);
        sum_after.store(result_after, lane);
    }
}

void block_radiance(const BlockNormals& normals, const BlockLight& light, BlockRadiance& radiance) {
    const hn::CappedTag<double, prt::BlockSize> d;
    const hn::Rebind<float, decltype(d)> floats;
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
        const auto nx = hn::PromoteTo(d, hn::LoadU(floats, normals.axes[0].data() + lane));
        const auto ny = hn::PromoteTo(d, hn::LoadU(floats, normals.axes[1].data() + lane));
        const auto nz = hn::PromoteTo(d, hn::LoadU(floats, normals.axes[2].data() + lane));
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const double* e = light.visible.data() + 3 * channel;
            const auto along_z = hn::Mul(nz, hn::Set(d, e[2]));
            const auto n_dot_e = hn::MulAdd(nx, hn::Set(d, e[0]), hn::MulAdd(ny, hn::Set(d, e[1]), along_z));
            const auto mixed = hn::LoadU(d, light.mixed[channel].data() + lane);
            // A whole cluster counts 16. Sums of nothing may round to a hair below zero.
            const auto sum = hn::Max(
                hn::Zero(d), hn::MulAdd(hn::Set(d, static_cast<double>(prt::FullCount)), n_dot_e, mixed));
            hn::StoreU(hn::DemoteTo(floats, sum), floats, radiance.channels[channel].data() + lane);
        }
    }
}

void light_tile(const prt::VisibleCounts& counts, std::size_t tile, const BlockNormals* normals,
                const ClusterLights& lights, BlockLight* light) {
    const std::size_t begin = counts.tile_begin(tile);
    const std::size_t end = counts.tile_begin(tile + 1);
    for (std::size_t block = begin; block < end; ++block)
        light[block] = {};
    std::size_t word = counts.word(begin, 0);
    for (std::size_t w = 0; w < counts.words_per_block(); ++w) {
        const float* vectors = lights.vectors.data() + w * 64 * ClusterLights::Stride;
        const double* prefix = lights.prefix.data() + w * 64 * ClusterLights::Stride;
        for (std::size_t block = begin; block < end; ++block, ++word) {
            // Runs of clusters that the whole block sees: one difference of prefix sums each.
            std::uint64_t visible = counts.visible[word];
            while (visible != 0) {
                const int first = std::countr_zero(visible);
                const int length = std::countr_one(visible >> first);
                const double* before = prefix + static_cast<std::size_t>(first) * ClusterLights::Stride;
                const double* after = before + static_cast<std::size_t>(length) * ClusterLights::Stride;
                for (std::size_t i = 0; i < ClusterLights::Stride; ++i)
                    light[block].visible[i] += after[i] - before[i];
                visible &= length == 64 ? 0 : ~(((std::uint64_t{1} << length) - 1) << first);
            }
            if (counts.mixed[word] == 0)
                continue;
            WordSum sum;
            sum_word(counts.mixed[word], counts.mixed_counts(word, 0), normals[block], vectors, sum);
            for (std::size_t channel = 0; channel < 3; ++channel)
                for (std::size_t i = 0; i < prt::BlockSize; ++i)
                    light[block].mixed[channel][i] += static_cast<double>(sum[channel][i]);
        }
    }
}

std::uint64_t update_tile(const prt::VisibleCounts& counts, std::size_t tile, const BlockNormals* normals,
                          std::span<const ChangedWord> changes, const float* all_before,
                          const float* all_after, BlockLight* light) {
    const std::size_t begin = counts.tile_begin(tile);
    const std::size_t end = counts.tile_begin(tile + 1);
    std::uint64_t touched = 0;
    for (const ChangedWord& change : changes) {
        const float* before = all_before + std::size_t{change.word} * 64 * ClusterLights::Stride;
        const float* after = all_after + std::size_t{change.word} * 64 * ClusterLights::Stride;
        std::size_t word = counts.word(begin, change.word);
        for (std::size_t block = begin; block < end; ++block, ++word) {
            const std::uint64_t mixed = counts.mixed[word];
            std::uint64_t visible = counts.visible[word] & change.clusters;
            if (visible == 0 && (mixed & change.clusters) == 0)
                continue;
            touched |= std::uint64_t{1} << (block - begin);
            for (; visible != 0; visible &= visible - 1) {
                const std::size_t first =
                    static_cast<std::size_t>(std::countr_zero(visible)) * ClusterLights::Stride;
                for (std::size_t i = 0; i < ClusterLights::Stride; ++i)
                    light[block].visible[i] +=
                        static_cast<double>(after[first + i]) - static_cast<double>(before[first + i]);
            }
            if ((mixed & change.clusters) == 0)
                continue;
            WordSum sum_before;
            WordSum sum_after;
            sum_word_twice(mixed, change.clusters, counts.mixed_counts(word, 0), normals[block], before,
                           after, sum_before, sum_after);
            for (std::size_t channel = 0; channel < 3; ++channel)
                for (std::size_t i = 0; i < prt::BlockSize; ++i)
                    light[block].mixed[channel][i] += static_cast<double>(sum_after[channel][i]) -
                                                      static_cast<double>(sum_before[channel][i]);
        }
    }
    return touched;
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

namespace {
HWY_EXPORT(block_radiance);
HWY_EXPORT(light_tile);
HWY_EXPORT(update_tile);
} // namespace

ClusterLights::ClusterLights(std::size_t num_clusters)
    : vectors(num_clusters * Stride), prefix((num_clusters + 1) * Stride) {}

void ClusterLights::set(std::size_t cluster, const VectorIrradiance& irradiance) {
    constexpr double Scale = 1.0 / (16.0 * std::numbers::pi);
    float* vector = vectors.data() + cluster * Stride;
    for (const glm::dvec3* channel : {&irradiance.red, &irradiance.green, &irradiance.blue})
        for (int axis = 0; axis < 3; ++axis)
            *vector++ = static_cast<float>((*channel)[axis] * Scale);
}

void ClusterLights::sum_prefix() {
    for (std::size_t i = 0; i < vectors.size(); ++i)
        prefix[i + Stride] = prefix[i] + static_cast<double>(vectors[i]);
}

void block_radiance(const BlockNormals& normals, const BlockLight& light, BlockRadiance& radiance) {
    HWY_DYNAMIC_DISPATCH(block_radiance)(normals, light, radiance);
}

void light_tile(const prt::VisibleCounts& counts, std::size_t tile, std::span<const BlockNormals> normals,
                const ClusterLights& lights, std::span<BlockLight> light) {
    HWY_DYNAMIC_DISPATCH(light_tile)(counts, tile, normals.data(), lights, light.data());
}

std::uint64_t update_tile(const prt::VisibleCounts& counts, std::size_t tile,
                          std::span<const BlockNormals> normals, std::span<const ChangedWord> changes,
                          std::span<const float> before, std::span<const float> after,
                          std::span<BlockLight> light) {
    return HWY_DYNAMIC_DISPATCH(update_tile)(counts, tile, normals.data(), changes, before.data(),
                                             after.data(), light.data());
}

} // namespace relumine::relight
#endif // HWY_ONCE
