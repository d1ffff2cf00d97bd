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

#include "relight/kernels/block_loops-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

namespace {

/// Tiles are walked through in steps of so many words, block by block: the clusters' fluxes and the
/// words of a step stay in the nearest cache.
constexpr std::size_t WordsPerStep = 16;

template<typename T>
using Tag = hn::CappedTag<T, prt::BlockSize>;

/// Groups that one block sees in part: their fluxes, until these meet the groups' bases.
template<typename T, std::size_t Count>
class GroupFluxes {
    using Vector = hn::Vec<Tag<T>>;
    /// Wide vectors come with registers for the sums of all channels.
    static constexpr std::size_t Channels = HWY_TARGET <= HWY_AVX3 ? 3 : 1;

public:
    static constexpr std::size_t Most = 128;

    /// Sums of a group's fluxes times counts, for the receivers from `lane` on.
    struct Sum {
        Vector red, green, blue;

        HWY_INLINE Sum() : red(hn::Zero(Tag<T>())), green(red), blue(red) {}
        HWY_INLINE void add(Vector count, const T* flux) {
            const Tag<T> d;
            red = hn::MulAdd(count, hn::Set(d, flux[0]), red);
            green = hn::MulAdd(count, hn::Set(d, flux[1]), green);
            blue = hn::MulAdd(count, hn::Set(d, flux[2]), blue);
        }
    };

    [[nodiscard]] std::size_t size() const { return size_; }

    /// Sets the receivers from `lane` on of an entry. Takes what is below their horizons off. Those
    /// without a normal have no horizon.
    HWY_INLINE void set(std::size_t entry, std::size_t lane, const HarmonicGroup& group,
                        const BlockNormals& normals, const Sum& sum) {
        const Tag<T> d;
        auto above = hn::Set(d, T{0.5});
        auto squares = hn::Zero(d);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto normal = load_normals(normals.axes[axis].data() + lane);
            squares = hn::MulAdd(normal, normal, squares);
            above = hn::MulAdd(normal, hn::Set(d, static_cast<T>(group.slope[axis])), above);
        }
        // 1 without a normal, 0 with one; comparisons of doubles are missing in WebAssembly.
        const auto all =
            hn::Max(hn::MulAdd(squares, hn::Set(d, T{-2}), hn::Set(d, T{1})), hn::Zero(d));
        above = hn::Min(hn::Max(hn::Add(above, all), hn::Zero(d)), hn::Set(d, T{1}));
        hn::Store(hn::Mul(above, sum.red), d, fluxes_[entry][0].data() + lane);
        hn::Store(hn::Mul(above, sum.green), d, fluxes_[entry][1].data() + lane);
        hn::Store(hn::Mul(above, sum.blue), d, fluxes_[entry][2].data() + lane);
    }
    /// Ends the entry behind the last. `basis` is [channel][coefficient].
    void push(const float* basis) { bases_[size_++] = basis; }

    /// Adds the fluxes times the bases to a block's sums, and forgets them.
    void multiply(double* sums) {
        if (size_ != 0)
            for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(Tag<T>()))
                for (std::size_t channel = 0; channel < 3; channel += Channels)
                    multiply(sums, lane, channel);
        size_ = 0;
    }

private:
    HWY_INLINE void multiply(double* sums, std::size_t lane, std::size_t first_channel) {
        const Tag<T> d;
        Vector products[Channels * Count];
        for (Vector& product : products)
            product = hn::Zero(d);
        for (std::size_t i = 0; i < size_; ++i) {
            const float* basis = bases_[i] + first_channel * Count;
#pragma GCC unroll 3
            for (std::size_t channel = 0; channel < Channels; ++channel) {
                const auto flux = hn::Load(d, fluxes_[i][first_channel + channel].data() + lane);
#pragma GCC unroll 9
                for (std::size_t k = 0; k < Count; ++k)
                    products[channel * Count + k] =
                        hn::MulAdd(flux, hn::Set(d, static_cast<T>(basis[channel * Count + k])),
                                   products[channel * Count + k]);
            }
        }
#pragma GCC unroll 27
        for (std::size_t k = 0; k < Channels * Count; ++k)
            add_to(sums + (first_channel * Count + k) * prt::BlockSize + lane, products[k]);
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

    std::size_t size_ = 0;
    std::array<const float*, Most> bases_;
    /// [group][channel][receiver]
    alignas(64) std::array<std::array<std::array<T, prt::BlockSize>, 3>, Most> fluxes_;
};

/// Adds the clusters of a word, group by group, to what one block sees in part. `cluster` is the
/// word's first.
template<std::size_t Count>
HWY_INLINE void add_pairs(const Pairs& pairs, const ClusterHarmonics& lights, std::size_t cluster,
                          const BlockNormals& normals, GroupFluxes<float, Count>& fluxes) {
    const Tag<float> d;
    const HarmonicGroup* groups = lights.groups().data();
    const std::uint32_t* group_of = lights.group_of().data() + cluster;
    const float* flux = lights.fluxes().data() + cluster * 3;
    const float* bases = lights.bases().data();
    const std::uint8_t* counts = pairs.counts;
    for (std::uint64_t rest = pairs.mixed | pairs.across; rest != 0;) {
        const std::size_t index = group_of[first_bit(rest)];
        const HarmonicGroup& group = groups[index];
        const std::size_t end = group.end - cluster;
        const std::uint64_t of_group = end < 64 ? rest & ((std::uint64_t{1} << end) - 1) : rest;
        rest &= ~of_group;
        for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
            typename GroupFluxes<float, Count>::Sum sum;
            const std::uint8_t* count = counts + lane;
            for (std::uint64_t bits = of_group & pairs.mixed; bits != 0;
                 bits &= bits - 1, count += prt::BlockSize)
                sum.add(load_counts(d, count), flux + first_bit(bits) * 3);
            for_bits(of_group & pairs.across, [&](std::size_t i) {
                sum.add(hn::Set(d, static_cast<float>(prt::FullCount)), flux + i * 3);
            });
            fluxes.set(fluxes.size(), lane, group, normals, sum);
        }
        counts += num_counts(of_group & pairs.mixed);
        fluxes.push(bases + index * lights.stride());
    }
}

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

/// Sums the clusters of runs: a sum of all clusters before each run's end, minus a sum of those
/// before its beginning. `prefix` begins at the word's first cluster.
template<std::size_t Eights>
HWY_INLINE void add_runs(const Runs& runs, const EightDoubles* prefix, double* sum) {
    const hn::CappedTag<double, 8> d;
    constexpr std::size_t Lanes = hn::MaxLanes(d), NumVectors = Eights * 8 / Lanes;
    hn::Vec<decltype(d)> sums[NumVectors];
    for (std::size_t i = 0; i < NumVectors; ++i)
        sums[i] = hn::Load(d, sum + i * Lanes);
    for_bits(runs.edges, [&](std::size_t bit) {
        const auto sign = hn::Set(d, (runs.visible >> bit & 1u) != 0 ? -1.0 : 1.0);
        const double* before = prefix[bit * Eights].numbers.data();
        for (std::size_t i = 0; i < NumVectors; ++i)
            sums[i] = hn::MulAdd(sign, hn::Load(d, before + i * Lanes), sums[i]);
    });
    for (std::size_t i = 0; i < NumVectors; ++i)
        hn::Store(sums[i], d, sum + i * Lanes);
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
    constexpr std::size_t Eights = (Stride + 7) / 8;
    const EightDoubles* prefix = lights.prefix().data();
    std::array<std::array<EightDoubles, Eights>, prt::VisibleCounts::TileBlocks> visible_sums{};
    chosen &= counts.tile_blocks(tile);
    for_bits(chosen, [&](std::size_t block) {
        std::fill_n(of_blocks.mixed + (begin + block) * Stride * prt::BlockSize,
                    Stride * prt::BlockSize, 0.0);
    });
    GroupFluxes<float, Count> fluxes;
    OpenRuns open;
    for (std::size_t first = 0; first < num_words; first += WordsPerStep) {
        const TileWord* of_tile = scene.words.words.data() + tile * num_words + first;
        // The words of the step that a block has work for.
        std::array<std::uint64_t, prt::VisibleCounts::TileBlocks> work{};
        for (std::size_t w = 0; w < std::min(WordsPerStep, num_words - first); ++w)
            for_bits((of_tile[w].edges | of_tile[w].mixed | of_tile[w].across) & chosen,
                     [&](std::size_t block) { work[block] |= std::uint64_t{1} << w; });
        for_bits(chosen, [&](std::size_t block) {
            double* visible_sum = visible_sums[block].front().numbers.data();
            double* mixed_sum = of_blocks.mixed + (begin + block) * Stride * prt::BlockSize;
            for_bits(work[block], [&](std::size_t w) {
                const std::size_t cluster = (first + w) * 64;
                const std::size_t word = counts.word(begin + block, first + w);
                const std::uint64_t across = scene.words.across_of(of_tile[w], block);
                if (const Runs runs = open.next(block, counts.visible[word] & ~across);
                    runs.edges != 0)
                    add_runs<Eights>(runs, prefix + cluster * Eights, visible_sum);
                const std::uint64_t mixed = counts.mixed[word];
                if ((mixed | across) == 0)
                    return;
                if (fluxes.size() + 64 > fluxes.Most)
                    fluxes.multiply(mixed_sum);
                add_pairs({.mixed = mixed, .across = across, .counts = counts_of(counts, word)},
                          lights, cluster, scene.normals[begin + block], fluxes);
            });
            fluxes.multiply(mixed_sum);
        });
    }
    for_bits(chosen, [&](std::size_t block) {
        double* visible_sum = visible_sums[block].front().numbers.data();
        add_runs<Eights>(open.last(block), prefix + num_words * 64 * Eights, visible_sum);
        std::copy_n(visible_sum, Stride, of_blocks.visible + (begin + block) * Stride);
    });
}

/// Adds a cluster of a changed group, as it is now and less what it was, to what a block sees in
/// part. `counts` is null for a cluster that is seen whole.
template<std::size_t Count>
void add_member(const HarmonicChanges& changes, const HarmonicChanges::Member& member,
                const std::uint8_t* counts, const HarmonicGroup& group, const BlockNormals& normals,
                GroupFluxes<double, Count>& fluxes) {
    const Tag<double> d;
    const auto add = [&](const std::array<double, 3>& flux, const std::vector<float>& bases) {
        for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
            typename GroupFluxes<double, Count>::Sum sum;
            sum.add(counts != nullptr ? load_counts(d, counts + lane)
                                      : hn::Set(d, static_cast<double>(prt::FullCount)),
                    flux.data());
            fluxes.set(fluxes.size(), lane, group, normals, sum);
        }
        fluxes.push(bases.data() + std::size_t{member.group} * 3 * Count);
    };
    add(member.before, changes.bases_before);
    add(member.now, changes.bases);
}

template<std::size_t Count>
std::uint64_t update_harmonics(const BlockScene& scene, std::size_t tile,
                               const ClusterHarmonics& lights, const HarmonicChanges& changes,
                               const HarmonicBlocks& of_blocks) {
    constexpr std::size_t Stride = 3 * Count;
    const prt::VisibleCounts& counts = scene.counts;
    const std::size_t begin = counts.tile_begin(tile);
    const std::size_t num_words = counts.words_per_block();
    GroupFluxes<double, Count> fluxes;
    std::uint64_t touched = 0;
    for_bits(counts.tile_blocks(tile), [&](std::size_t block) {
        double* visible_sum = of_blocks.visible + (begin + block) * Stride;
        double* mixed_sum = of_blocks.mixed + (begin + block) * Stride * prt::BlockSize;
        for (std::size_t c = 0; c < changes.words.size(); ++c) {
            const HarmonicChanges::Word& change = changes.words[c];
            const TileWord& of_tile = scene.words.words[tile * num_words + change.word];
            const std::size_t word = counts.word(begin + block, change.word);
            const std::uint64_t all_across = scene.words.across_of(of_tile, block);
            const std::uint64_t all_mixed = counts.mixed[word];
            const std::uint64_t whole = counts.visible[word] & change.changed & ~all_across;
            const std::uint64_t per_receiver = (all_mixed | all_across) & change.members;
            if ((whole | per_receiver) == 0)
                continue;
            touched |= std::uint64_t{1} << block;
            const auto index_of = [](std::uint64_t bits, std::size_t i) {
                return static_cast<std::size_t>(
                    std::popcount(bits & ((std::uint64_t{1} << i) - 1)));
            };
            if (whole == change.changed)
                add_scaled(changes.word_values.data() + c * Stride, 1.0, Stride, visible_sum);
            else
                for_bits(whole, [&](std::size_t i) {
                    add_scaled(changes.values.data() +
                                   (change.first_changed + index_of(change.changed, i)) * Stride,
                               1.0, Stride, visible_sum);
                });
            for_bits(per_receiver, [&](std::size_t i) {
                if (fluxes.size() + 2 > fluxes.Most)
                    fluxes.multiply(mixed_sum);
                const HarmonicChanges::Member& member =
                    changes.members[change.first_member + index_of(change.members, i)];
                add_member(changes, member,
                           (all_mixed >> i & 1u) != 0
                               ? counts_of(counts, word) + index_of(all_mixed, i) * prt::BlockSize
                               : nullptr,
                           lights.groups()[changes.groups[member.group]],
                           scene.normals[begin + block], fluxes);
            });
        }
        fluxes.multiply(mixed_sum);
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
