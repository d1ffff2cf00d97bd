#include "prt/clusters/cluster_kernels.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "prt/clusters/horizon.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "prt/clusters/cluster_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::prt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Float sums run over at most this many words (1,024 receivers, a tile of VisibleCounts) before
// they become whole numbers. The relative error of the floats is below 1e-4 of the tolerance test's
// threshold, and the threshold is itself a choice.
constexpr std::size_t WordsPerRun = 16;

/// Returns bits [first, first + Lanes) of a word as a lane mask.
template<class D>
hn::Mask<D> mask_of(D d, std::uint64_t word, std::size_t first) {
    const std::uint64_t bits = word >> first;
    std::uint8_t bytes[8];
    std::memcpy(bytes, &bits, sizeof bytes);
    return hn::LoadMaskBits(d, bytes);
}

void squared_distances(const NormalArrays& normals, const CellSamples& samples,
                       std::int64_t* sums) {
    const hn::CappedTag<float, 16> d;
    using Vector = hn::Vec<decltype(d)>;
    const std::size_t num_lanes = hn::Lanes(d);
    for (std::size_t l = 0; l < SamplesPerCell; ++l)
        sums[l] = 0;

    for (std::size_t run = 0; run < normals.num_words(); run += WordsPerRun) {
        Vector square_sums[SamplesPerCell];
        for (Vector& sum : square_sums)
            sum = hn::Zero(d);
        const std::size_t run_end = std::min(run + WordsPerRun, normals.num_words());
        for (std::size_t word = run; word < run_end; ++word) {
            std::uint64_t any = 0;
            for (const std::uint64_t* lit : samples.lit)
                any |= lit[word];
            if (any == 0)
                continue; // 64 receivers that see no sample add nothing
            for (std::size_t lane = 0; lane < WordSize; lane += num_lanes) {
                const std::size_t at = word * WordSize + lane;
                const auto nx = hn::LoadU(d, normals.x.data() + at);
                const auto ny = hn::LoadU(d, normals.y.data() + at);
                const auto nz = hn::LoadU(d, normals.z.data() + at);
                const auto nw = hn::LoadU(d, normals.w.data() + at);
                Vector transfer[SamplesPerCell]; // T_l [JN, Eq. 2]
                Vector mean = hn::Zero(d);       // T_C [JN, Eq. 10]
                for (std::size_t l = 0; l < SamplesPerCell; ++l) {
                    const glm::vec3& w = samples.directions[l];
                    const auto along_z = hn::MulAdd(nz, hn::Set(d, w.z), nw);
                    const auto cosine =
                        hn::MulAdd(nx, hn::Set(d, w.x), hn::MulAdd(ny, hn::Set(d, w.y), along_z));
                    transfer[l] =
                        hn::IfThenElseZero(mask_of(d, samples.lit[l][word], lane), cosine);
                    mean = hn::MulAdd(transfer[l],
                                      hn::Set(d, static_cast<float>(SampleWeights[l]) / FullCount),
                                      mean);
                }
                for (std::size_t l = 0; l < SamplesPerCell; ++l) {
                    const auto difference = hn::Sub(transfer[l], mean);
                    square_sums[l] = hn::MulAdd(difference, difference, square_sums[l]);
                }
            }
        }
        for (std::size_t l = 0; l < SamplesPerCell; ++l)
            sums[l] += std::llrint(double{hn::GetLane(hn::SumOfLanes(d, square_sums[l]))} /
                                   SquaredDistanceUnit);
    }
}

} // namespace relumine::prt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::prt {

namespace {

HWY_EXPORT(squared_distances);

/// Returns a table that spreads eight bits to eight counters: byte i of entry b is bit i of b.
std::array<std::uint64_t, 256> bytes_from_bits() {
    std::array<std::uint64_t, 256> table{};
    for (std::uint64_t bits = 0; bits < table.size(); ++bits)
        for (std::uint64_t i = 0; i < 8; ++i)
            table[bits] |= (bits >> i & 1u) << (8 * i);
    return table;
}

/// Returns round(16 s / a) at [a][s]; 0 where a is 0. There are no halves to round: 32 s / a is no
/// odd number for any a up to 16.
constexpr std::array<std::array<std::uint8_t, FullCount + 1>, FullCount + 1> visible_parts() {
    std::array<std::array<std::uint8_t, FullCount + 1>, FullCount + 1> table{};
    for (std::size_t above = 1; above <= FullCount; ++above)
        for (std::size_t seen = 0; seen <= FullCount; ++seen)
            table[above][seen] = static_cast<std::uint8_t>(
                seen >= above ? FullCount
                              : (std::size_t{2} * FullCount * seen + above) / (2 * above));
    return table;
}

} // namespace

NormalArrays::NormalArrays(std::span<const glm::vec3> normals, std::size_t num_points) {
    const std::size_t num_padded = (normals.size() + WordSize - 1) / WordSize * WordSize;
    x.resize(num_padded);
    y.resize(num_padded);
    z.resize(num_padded);
    w.resize(num_padded);
    std::fill_n(w.begin(), num_points, 1.0f);
    for (std::size_t i = 0; i < normals.size(); ++i) {
        x[i] = normals[i].x;
        y[i] = normals[i].y;
        z[i] = normals[i].z;
    }
}

std::array<std::int64_t, SamplesPerCell> squared_distances(const NormalArrays& normals,
                                                           const CellSamples& samples) {
    std::array<std::int64_t, SamplesPerCell> sums{};
    HWY_DYNAMIC_DISPATCH(squared_distances)(normals, samples, sums.data());
    return sums;
}

std::array<std::uint8_t, BlockSize>
weights_of(const std::array<std::uint16_t, SamplesPerCell>& samples,
           const std::array<std::uint8_t, SamplesPerCell>& weights) {
    static const std::array<std::uint64_t, 256> Bytes = bytes_from_bits();
    std::array<std::uint64_t, 2> sums{};
    for (std::size_t l = 0; l < SamplesPerCell; ++l) {
        sums[0] += Bytes[samples[l] & 0xffu] * weights[l];
        sums[1] += Bytes[samples[l] >> 8u] * weights[l];
    }
    static_assert(std::endian::native == std::endian::little, "byte i of a word is receiver i");
    return std::bit_cast<std::array<std::uint8_t, BlockSize>>(sums);
}

bool divide_by_weight_above(std::span<std::uint8_t, BlockSize> seen,
                            std::span<const std::uint8_t, BlockSize> above) {
    static constexpr auto VisibleParts = visible_parts();
    bool all = true;
    for (std::size_t i = 0; i < BlockSize; ++i) {
        seen[i] = VisibleParts[above[i]][seen[i]];
        all = all && (above[i] == 0 || seen[i] == FullCount);
    }
    return all;
}

LeafColumn leaf_column(const NormalArrays& normals, const CellSamples& samples,
                       const std::array<std::uint8_t, SamplesPerCell>& weights,
                       std::size_t num_receivers) {
    constexpr std::size_t BlocksPerWord = WordSize / BlockSize;
    const std::size_t num_blocks = (num_receivers + BlockSize - 1) / BlockSize;
    LeafColumn column;
    column.visible.resize((num_blocks + 63) / 64);
    column.mixed.resize((num_blocks + 63) / 64);
    const auto add_block = [&](std::size_t block,
                               const std::array<std::uint16_t, SamplesPerCell>& lit) {
        const std::uint64_t bit = std::uint64_t{1} << (block % 64);
        // Lanes after the last receiver have no normal and so nothing above a horizon. They never
        // make a block mixed.
        std::array<std::uint8_t, BlockSize> counts = weights_of(lit, weights);
        const std::array<std::uint8_t, BlockSize> above = weights_of(
            samples_above_horizon(normals, block * BlockSize, samples.directions), weights);
        if (divide_by_weight_above(counts, above)) {
            column.visible[block / 64] |= bit;
        } else {
            column.mixed[block / 64] |= bit;
            column.counts.insert(column.counts.end(), counts.begin(), counts.end());
        }
    };
    for (std::size_t word = 0; word * BlocksPerWord < num_blocks; ++word) {
        std::array<std::uint64_t, SamplesPerCell> lit{};
        std::uint64_t any = 0;
        std::uint64_t all = ~std::uint64_t{0};
        for (std::size_t l = 0; l < SamplesPerCell; ++l) {
            if (weights[l] == 0)
                continue;
            lit[l] = samples.lit[l][word];
            any |= lit[l];
            all &= lit[l];
        }
        for (std::size_t i = 0; any != 0 && i < BlocksPerWord;
             ++i, any >>= BlockSize, all >>= BlockSize) {
            const std::size_t block = word * BlocksPerWord + i;
            if (static_cast<std::uint16_t>(any) == 0)
                continue;
            if (static_cast<std::uint16_t>(all) == 0xffff) {
                column.visible[block / 64] |= std::uint64_t{1} << (block % 64);
                continue;
            }
            std::array<std::uint16_t, SamplesPerCell> of_block;
            for (std::size_t l = 0; l < SamplesPerCell; ++l)
                of_block[l] = static_cast<std::uint16_t>(lit[l] >> (i * BlockSize));
            add_block(block, of_block);
        }
    }
    return column;
}

} // namespace relumine::prt
#endif // HWY_ONCE
