#include "relight/harmonics/harmonic_kernels.h"

#include <algorithm>
#include <array>
#include <bit>

#include "prt/clusters/lattice.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/harmonics/harmonic_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

namespace {

/// Tiles are walked through in steps of so many words, block by block: the clusters' fluxes and the
/// words of a step stay in the nearest cache.
constexpr std::size_t WordsPerStep = 16;

template<typename T>
using Tag = hn::CappedTag<T, prt::BlockSize>;

std::size_t first_bit(std::uint64_t bits) {
    return static_cast<std::size_t>(std::countr_zero(bits));
}

/// Calls visit(block) for the set bits.
template<class Visit>
void for_bits(std::uint64_t bits, const Visit& visit) {
    for (; bits != 0; bits &= bits - 1)
        visit(first_bit(bits));
}

/// Returns 16 counts as numbers of type T, from `lane` on.
template<typename T>
hn::Vec<Tag<T>> load_counts(const std::uint8_t* counts) {
    const Tag<T> d;
    if constexpr (sizeof(T) == sizeof(float)) {
        const hn::Rebind<std::uint8_t, Tag<T>> bytes;
        const hn::Rebind<std::int32_t, Tag<T>> integers;
        return hn::ConvertTo(d, hn::PromoteTo(integers, hn::LoadU(bytes, counts)));
    } else {
        const hn::Rebind<std::uint8_t, Tag<T>> bytes;
        const hn::Rebind<std::int32_t, Tag<T>> integers;
        return hn::PromoteTo(d, hn::PromoteTo(integers, hn::LoadU(bytes, counts)));
    }
}

/// The clusters of a block and a word that add up per receiver, ascending.
struct Pairs {
    /// Bits of the word.
    std::uint64_t bits;
    /// Those that the block sees in part; it sees the others whole, across a horizon.
    std::uint64_t mixed;
    /// Counts of the first mixed one.
    const std::uint8_t* counts;
    const BlockNormals& normals;
};

/// Fluxes of groups that one block sees in part, until their basis functions are multiplied.
template<typename T>
class GroupFluxes {
public:
    GroupFluxes(const ClusterHarmonics& lights, float above)
        : groups_(lights.groups().data()), above_(above) {}

    [[nodiscard]] bool is_full() const { return size_ > Most - 64; }

    /// Sums pairs of a word. `group_of(bit)` tells a cluster's group, `flux_of(bit)` its three
    /// fluxes.
    template<class GroupOf, class FluxOf>
    HWY_INLINE void add(const Pairs& pairs, const GroupOf& group_of, const FluxOf& flux_of) {
        const Tag<T> d;
        std::size_t entry = size_;
        for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
            entry = size_;
            const std::uint8_t* counts = pairs.counts + lane;
            std::size_t bit = first_bit(pairs.bits);
            std::uint32_t group = group_of(bit);
            auto red = hn::Zero(d), green = red, blue = red;
            for (std::uint64_t bits = pairs.bits; bits != 0; bits &= bits - 1) {
                bit = first_bit(bits);
                if (const std::uint32_t next = group_of(bit); next != group) {
                    finish(entry++, lane, group, pairs.normals, red, green, blue);
                    group = next;
                    red = green = blue = hn::Zero(d);
                }
                auto count = hn::Set(d, static_cast<T>(prt::FullCount));
                if ((pairs.mixed >> bit & 1u) != 0) {
                    count = load_counts<T>(counts);
                    counts += prt::BlockSize;
                }
                const T* flux = flux_of(bit);
                red = hn::MulAdd(count, hn::Set(d, flux[0]), red);
                green = hn::MulAdd(count, hn::Set(d, flux[1]), green);
                blue = hn::MulAdd(count, hn::Set(d, flux[2]), blue);
            }
            finish(entry++, lane, group, pairs.normals, red, green, blue);
        }
        size_ = entry;
    }

    /// Adds the fluxes times the basis functions to a block's sums.
    template<std::size_t Count>
    void multiply(double* sums) {
        const Tag<T> d;
        for (std::size_t lane = 0; lane < prt::BlockSize && size_ != 0; lane += hn::Lanes(d))
            for (std::size_t channel = 0; channel < 3; ++channel) {
                hn::Vec<Tag<T>> products[Count];
                for (auto& product : products)
                    product = hn::Zero(d);
                for (std::size_t i = 0; i < size_; ++i) {
                    const auto flux = hn::Load(d, fluxes_[i][channel].data() + lane);
                    const float* basis = groups_[group_[i]].basis.data();
#pragma GCC unroll 9
                    for (std::size_t k = 0; k < Count; ++k)
                        products[k] =
                            hn::MulAdd(flux, hn::Set(d, static_cast<T>(basis[k])), products[k]);
                }
#pragma GCC unroll 9
                for (std::size_t k = 0; k < Count; ++k)
                    add_to(sums + (channel * Count + k) * prt::BlockSize + lane, products[k]);
            }
        size_ = 0;
    }

private:
    static constexpr std::size_t Most = 128;
    using Vector = hn::Vec<Tag<T>>;

    /// Takes what is below the receivers' horizons off a group's fluxes.
    HWY_INLINE void finish(std::size_t entry, std::size_t lane, std::uint32_t group,
                           const BlockNormals& normals, Vector red, Vector green, Vector blue) {
        const Tag<T> d;
        const HarmonicGroup& of_group = groups_[group];
        auto above = hn::Set(d, static_cast<T>(above_));
        for (std::size_t axis = 0; axis < 3; ++axis)
            above = hn::MulAdd(load_normals(normals.axes[axis].data() + lane),
                               hn::Set(d, static_cast<T>(of_group.slope[axis])), above);
        above = hn::Min(hn::Max(above, hn::Zero(d)), hn::Set(d, T{1}));
        group_[entry] = group;
        hn::Store(hn::Mul(above, red), d, fluxes_[entry][0].data() + lane);
        hn::Store(hn::Mul(above, green), d, fluxes_[entry][1].data() + lane);
        hn::Store(hn::Mul(above, blue), d, fluxes_[entry][2].data() + lane);
    }

    static HWY_INLINE Vector load_normals(const float* normals) {
        if constexpr (sizeof(T) == sizeof(float))
            return hn::LoadU(Tag<T>(), normals);
        else
            return hn::PromoteTo(Tag<T>(), hn::LoadU(hn::Rebind<float, Tag<T>>(), normals));
    }

    static HWY_INLINE void add_to(double* sums, Vector part) {
        if constexpr (sizeof(T) == sizeof(double)) {
            hn::StoreU(hn::Add(hn::LoadU(Tag<T>(), sums), part), Tag<T>(), sums);
        } else {
            alignas(64) std::array<float, prt::BlockSize> values;
            hn::Store(part, Tag<T>(), values.data());
            const hn::CappedTag<double, prt::BlockSize> doubles;
            const hn::Rebind<float, decltype(doubles)> floats;
            for (std::size_t i = 0; i < hn::Lanes(Tag<T>()); i += hn::Lanes(doubles))
                hn::StoreU(hn::Add(hn::LoadU(doubles, sums + i),
                                   hn::PromoteTo(doubles, hn::LoadU(floats, values.data() + i))),
                           doubles, sums + i);
        }
    }

    const HarmonicGroup* groups_;
    float above_;
    std::size_t size_ = 0;
    std::array<std::uint32_t, Most> group_;
    /// [group][channel][receiver]
    alignas(64) std::array<std::array<std::array<T, prt::BlockSize>, 3>, Most> fluxes_;
};

/// Adds sign times `values` to a sum.
void add_scaled(const double* values, double sign, std::size_t stride, double* sum) {
    const hn::CappedTag<double, 8> d;
    std::size_t i = 0;
    for (; i + hn::Lanes(d) <= stride; i += hn::Lanes(d))
        hn::StoreU(hn::MulAdd(hn::Set(d, sign), hn::LoadU(d, values + i), hn::LoadU(d, sum + i)), d,
                   sum + i);
    for (; i < stride; ++i)
        sum[i] += sign * values[i];
}

/// Where the counts of a block's word begin.
const std::uint8_t* counts_of(const prt::VisibleCounts& counts, std::size_t word) {
    return counts.counts.data() + counts.mixed_before[word] * prt::BlockSize;
}

template<std::size_t Count>
void light_harmonics(const BlockScene& scene, std::size_t tile, const ClusterHarmonics& lights,
                     std::uint64_t chosen, const HarmonicBlocks& of_blocks) {
    constexpr std::size_t Stride = 3 * Count;
    const prt::VisibleCounts& counts = scene.counts;
    const std::size_t begin = counts.tile_begin(tile);
    const std::size_t num_words = counts.words_per_block();
    const double* prefix = lights.prefix().data();
    const float* fluxes = lights.fluxes().data();
    const std::uint32_t* group_of = lights.group_of().data();
    chosen &= counts.tile_blocks(tile);
    for_bits(chosen, [&](std::size_t block) {
        std::fill_n(of_blocks.visible + (begin + block) * Stride, Stride, 0.0);
        std::fill_n(of_blocks.mixed + (begin + block) * Stride * prt::BlockSize,
                    Stride * prt::BlockSize, 0.0);
    });
    GroupFluxes<float> groups(lights, of_blocks.above);
    std::uint64_t inside = 0; // blocks in the middle of a run
    for (std::size_t first = 0; first < num_words; first += WordsPerStep)
        for_bits(chosen, [&](std::size_t block) {
            double* visible_sum = of_blocks.visible + (begin + block) * Stride;
            double* mixed_sum = of_blocks.mixed + (begin + block) * Stride * prt::BlockSize;
            for (std::size_t w = first; w < std::min(first + WordsPerStep, num_words); ++w) {
                const TileWord& of_tile = scene.words.words[tile * num_words + w];
                const std::size_t word = counts.word(begin + block, w);
                const std::uint64_t across = scene.words.across_of(of_tile, block);
                const std::uint64_t visible = counts.visible[word] & ~across;
                for_bits(visible ^ (visible << 1 | (inside >> block & 1u)), [&](std::size_t i) {
                    add_scaled(prefix + (w * 64 + i) * Stride,
                               (visible >> i & 1u) != 0 ? -1.0 : 1.0, Stride, visible_sum);
                });
                inside = (inside & ~(std::uint64_t{1} << block)) | visible >> 63 << block;
                const std::uint64_t mixed = counts.mixed[word];
                if ((mixed | across) == 0)
                    continue;
                groups.add(
                    {.bits = mixed | across,
                     .mixed = mixed,
                     .counts = counts_of(counts, word),
                     .normals = scene.normals[begin + block]},
                    [&](std::size_t i) { return group_of[w * 64 + i]; },
                    [&](std::size_t i) { return fluxes + (w * 64 + i) * 3; });
                if (groups.is_full())
                    groups.template multiply<Count>(mixed_sum);
            }
            groups.template multiply<Count>(mixed_sum);
        });
    // A run up to the last bit of the last word ends behind it.
    for_bits(inside, [&](std::size_t block) {
        add_scaled(prefix + num_words * 64 * Stride, 1.0, Stride,
                   of_blocks.visible + (begin + block) * Stride);
    });
}

template<std::size_t Count>
std::uint64_t update_harmonics(const BlockScene& scene, std::size_t tile,
                               const ClusterHarmonics& lights, const HarmonicChanges& changes,
                               const HarmonicBlocks& of_blocks) {
    constexpr std::size_t Stride = 3 * Count;
    const prt::VisibleCounts& counts = scene.counts;
    const std::size_t begin = counts.tile_begin(tile);
    const std::size_t num_words = counts.words_per_block();
    GroupFluxes<double> groups(lights, of_blocks.above);
    std::uint64_t touched = 0;
    for_bits(counts.tile_blocks(tile), [&](std::size_t block) {
        double* visible_sum = of_blocks.visible + (begin + block) * Stride;
        double* mixed_sum = of_blocks.mixed + (begin + block) * Stride * prt::BlockSize;
        for (std::size_t c = 0; c < changes.words.size(); ++c) {
            const HarmonicChanges::Word& change = changes.words[c];
            const TileWord& of_tile = scene.words.words[tile * num_words + change.word];
            const std::size_t word = counts.word(begin + block, change.word);
            const std::uint64_t seen = counts.visible[word] & change.clusters;
            const std::uint64_t across = scene.words.across_of(of_tile, block) & seen;
            const std::uint64_t all_mixed = counts.mixed[word];
            const std::uint64_t mixed = all_mixed & change.clusters;
            if ((seen | mixed) == 0)
                continue;
            touched |= std::uint64_t{1} << block;
            const auto index_of = [&](std::size_t i) {
                return change.first + static_cast<std::size_t>(std::popcount(
                                          change.clusters & ((std::uint64_t{1} << i) - 1)));
            };
            const std::uint64_t whole = seen & ~across;
            if (whole == change.clusters)
                add_scaled(changes.word_values.data() + c * Stride, 1.0, Stride, visible_sum);
            else
                for_bits(whole, [&](std::size_t i) {
                    add_scaled(changes.values.data() + index_of(i) * Stride, 1.0, Stride,
                               visible_sum);
                });
            // One by one: the counts of mixed clusters that did not change lie between.
            for_bits(mixed | across, [&](std::size_t i) {
                const std::uint64_t bit = std::uint64_t{1} << i;
                const auto before = static_cast<std::size_t>(std::popcount(all_mixed & (bit - 1)));
                const std::size_t index = index_of(i);
                groups.add(
                    {.bits = bit,
                     .mixed = mixed & bit,
                     .counts = counts_of(counts, word) + before * prt::BlockSize,
                     .normals = scene.normals[begin + block]},
                    [&](std::size_t) { return changes.groups[index]; },
                    [&](std::size_t) { return changes.fluxes.data() + index * 3; });
                if (groups.is_full())
                    groups.template multiply<Count>(mixed_sum);
            });
        }
        groups.template multiply<Count>(mixed_sum);
    });
    return touched;
}

} // namespace

void light_by_order(const BlockScene& scene, std::size_t tile, const ClusterHarmonics& lights,
                    std::uint64_t chosen, const HarmonicBlocks& blocks) {
    if (lights.order() == 1)
        light_harmonics<1>(scene, tile, lights, chosen, blocks);
    else if (lights.order() == 2)
        light_harmonics<4>(scene, tile, lights, chosen, blocks);
    else
        light_harmonics<9>(scene, tile, lights, chosen, blocks);
}

std::uint64_t update_by_order(const BlockScene& scene, std::size_t tile,
                              const ClusterHarmonics& lights, const HarmonicChanges& changes,
                              const HarmonicBlocks& blocks) {
    if (lights.order() == 1)
        return update_harmonics<1>(scene, tile, lights, changes, blocks);
    if (lights.order() == 2)
        return update_harmonics<4>(scene, tile, lights, changes, blocks);
    return update_harmonics<9>(scene, tile, lights, changes, blocks);
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

namespace {
HWY_EXPORT(light_by_order);
HWY_EXPORT(update_by_order);
} // namespace

void light_harmonics(const BlockScene& scene, std::size_t tile, const ClusterHarmonics& lights,
                     std::uint64_t chosen, const HarmonicBlocks& blocks) {
    HWY_DYNAMIC_DISPATCH(light_by_order)(scene, tile, lights, chosen, blocks);
}

std::uint64_t update_harmonics(const BlockScene& scene, std::size_t tile,
                               const ClusterHarmonics& lights, const HarmonicChanges& changes,
                               const HarmonicBlocks& blocks) {
    return HWY_DYNAMIC_DISPATCH(update_by_order)(scene, tile, lights, changes, blocks);
}

} // namespace relumine::relight
#endif // HWY_ONCE
