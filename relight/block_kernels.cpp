#include "relight/block_kernels.h"

#include <algorithm>
#include <bit>
#include <numbers>

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

/// Sums c max(n.E, 0) over the set bits of `mixed`; `counts` and `vectors` begin at the word's first entry and cluster.
void sum_word(std::uint64_t mixed, const std::uint8_t* counts, const BlockNormals& normals,
              const float* vectors, WordSum& sum) {
    const hn::CappedTag<float, prt::BlockSize> d;
    const hn::Rebind<std::uint8_t, decltype(d)> bytes;
    const hn::Rebind<std::int32_t, decltype(d)> integers;
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
        const auto nx = hn::LoadU(d, normals.axes[0].data() + lane);
        const auto ny = hn::LoadU(d, normals.axes[1].data() + lane);
        const auto nz = hn::LoadU(d, normals.axes[2].data() + lane);
        auto red = hn::Zero(d);
        auto green = hn::Zero(d);
        auto blue = hn::Zero(d);
        const auto cosine = [&](const float* e) {
            const auto along_z = hn::Mul(nz, hn::Set(d, e[2]));
            const auto n_dot_e = hn::MulAdd(nx, hn::Set(d, e[0]), hn::MulAdd(ny, hn::Set(d, e[1]), along_z));
            return hn::Max(n_dot_e, hn::Zero(d));
        };
        const std::uint8_t* entry = counts + lane;
        for (std::uint64_t bits = mixed; bits != 0; bits &= bits - 1, entry += prt::BlockSize) {
            const auto cluster = static_cast<std::size_t>(std::countr_zero(bits));
            const float* e = vectors + cluster * ClusterLights::Stride;
            const auto count = hn::ConvertTo(d, hn::PromoteTo(integers, hn::LoadU(bytes, entry)));
            red = hn::MulAdd(count, cosine(e), red);
            green = hn::MulAdd(count, cosine(e + 3), green);
            blue = hn::MulAdd(count, cosine(e + 6), blue);
        }
        hn::StoreU(red, d, sum[0].data() + lane);
        hn::StoreU(green, d, sum[1].data() + lane);
        hn::StoreU(blue, d, sum[2].data() + lane);
    }
}

void light_block(const prt::VisibleCounts& counts, std::size_t block, const BlockNormals& normals,
                 const ClusterLights& lights, BlockLight& light) {
    light = {};
    const std::size_t words = counts.words_per_block();
    for (std::size_t w = 0; w < words; ++w) {
        const std::size_t word = block * words + w;
        // Runs of clusters that the whole block sees: one difference of prefix sums each.
        std::uint64_t visible = counts.visible[word];
        while (visible != 0) {
            const int begin = std::countr_zero(visible);
            const int length = std::countr_one(visible >> begin);
            const double* before =
                lights.prefix.data() + (w * 64 + static_cast<std::size_t>(begin)) * ClusterLights::Stride;
            const double* after = before + static_cast<std::size_t>(length) * ClusterLights::Stride;
            for (std::size_t i = 0; i < ClusterLights::Stride; ++i)
                light.visible[i] += after[i] - before[i];
            visible &= length == 64 ? 0 : ~(((std::uint64_t{1} << length) - 1) << begin);
        }
        if (counts.mixed[word] == 0)
            continue;
        WordSum sum;
        sum_word(counts.mixed[word], counts.mixed_counts(word, 0), normals,
                 lights.vectors.data() + w * 64 * ClusterLights::Stride, sum);
        for (std::size_t channel = 0; channel < 3; ++channel)
            for (std::size_t i = 0; i < prt::BlockSize; ++i)
                light.mixed[channel][i] += static_cast<double>(sum[channel][i]);
    }
}

bool update_block(const prt::VisibleCounts& counts, std::size_t block, const BlockNormals& normals,
                  std::span<const ChangedWord> changes, const float* before, const float* after,
                  BlockLight& light) {
    bool touched = false;
    for (const ChangedWord& change : changes) {
        const std::size_t word = block * counts.words_per_block() + change.word;
        const std::size_t first = std::size_t{change.word} * 64 * ClusterLights::Stride;
        for (std::uint64_t bits = counts.visible[word] & change.clusters; bits != 0; bits &= bits - 1) {
            const std::size_t cluster =
                static_cast<std::size_t>(std::countr_zero(bits)) * ClusterLights::Stride;
            for (std::size_t i = 0; i < ClusterLights::Stride; ++i)
                light.visible[i] += static_cast<double>(after[first + cluster + i]) -
                                    static_cast<double>(before[first + cluster + i]);
            touched = true;
        }
        if ((counts.mixed[word] & change.clusters) == 0)
            continue;
        WordSum old_sum;
        WordSum new_sum;
        const std::uint8_t* entries = counts.mixed_counts(word, 0);
        sum_word(counts.mixed[word], entries, normals, before + first, old_sum);
        sum_word(counts.mixed[word], entries, normals, after + first, new_sum);
        for (std::size_t channel = 0; channel < 3; ++channel)
            for (std::size_t i = 0; i < prt::BlockSize; ++i)
                light.mixed[channel][i] +=
                    static_cast<double>(new_sum[channel][i]) - static_cast<double>(old_sum[channel][i]);
        touched = true;
    }
    return touched;
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

namespace {
HWY_EXPORT(light_block);
HWY_EXPORT(update_block);
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

void light_block(const prt::VisibleCounts& counts, std::size_t block, const BlockNormals& normals,
                 const ClusterLights& lights, BlockLight& light) {
    HWY_DYNAMIC_DISPATCH(light_block)(counts, block, normals, lights, light);
}

bool update_block(const prt::VisibleCounts& counts, std::size_t block, const BlockNormals& normals,
                  std::span<const ChangedWord> changes, std::span<const float> before,
                  std::span<const float> after, BlockLight& light) {
    return HWY_DYNAMIC_DISPATCH(update_block)(counts, block, normals, changes, before.data(), after.data(),
                                              light);
}

} // namespace relumine::relight
#endif // HWY_ONCE
