#include "relight/block_kernels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "prt/clusters/lattice.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/block_kernels.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

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

template<class D>
hn::Vec<D> load_counts(D d, const std::uint8_t* counts) {
    const hn::Rebind<std::uint8_t, D> bytes;
    const hn::Rebind<std::int32_t, D> integers;
    return hn::ConvertTo(d, hn::PromoteTo(integers, hn::LoadU(bytes, counts)));
}

std::size_t first_bit(std::uint64_t bits) {
    return static_cast<std::size_t>(std::countr_zero(bits));
}

/// The light of a word's clusters.
struct WordLights {
    const float* vectors;
    const float* beams;
    std::uint64_t spread;
};

/// The clusters of a block and word that add up per receiver.
struct PairWord {
    /// Seen in part.
    std::uint64_t mixed;
    /// Seen whole, across a horizon.
    std::uint64_t across;
    /// Begins at the first entry of `mixed`.
    const std::uint8_t* counts;
    const BlockNormals& normals;
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

/// Adds max(n.E, 0) of clusters.
template<bool AnySpread>
void add_whole(std::uint64_t bits, const Normals<Floats>& n, const WordLights& lights, Sum& sum) {
    const auto zero = hn::Zero(Floats());
    const float* beams = lights.beams;
    for (; bits != 0; bits &= bits - 1) {
        const std::size_t i = first_bit(bits);
        if (AnySpread && (lights.spread >> i & 1u) != 0) {
            const float* e = lights.vectors + i * ClusterLights::Stride;
            sum.red = hn::Add(sum.red, hn::Max(n.dot(e), zero));
            sum.green = hn::Add(sum.green, hn::Max(n.dot(e + 3), zero));
            sum.blue = hn::Add(sum.blue, hn::Max(n.dot(e + 6), zero));
        } else {
            const float* beam = beams + i * ClusterLights::BeamStride;
            sum.add(hn::Max(n.dot(beam), zero), beam + 3);
        }
    }
}

/// Adds c max(n.E, 0) of clusters.
template<bool AnySpread>
void add_counted(std::uint64_t bits, const std::uint8_t* counts, const Normals<Floats>& n,
                 const WordLights& lights, Sum& sum) {
    const Floats d;
    const auto zero = hn::Zero(d);
    const float* beams = lights.beams;
    for (; bits != 0; bits &= bits - 1, counts += prt::BlockSize) {
        const std::size_t i = first_bit(bits);
        const auto count = load_counts(d, counts);
        if (AnySpread && (lights.spread >> i & 1u) != 0) {
            const float* e = lights.vectors + i * ClusterLights::Stride;
            sum.red = hn::MulAdd(count, hn::Max(n.dot(e), zero), sum.red);
            sum.green = hn::MulAdd(count, hn::Max(n.dot(e + 3), zero), sum.green);
            sum.blue = hn::MulAdd(count, hn::Max(n.dot(e + 6), zero), sum.blue);
        } else {
            const float* beam = beams + i * ClusterLights::BeamStride;
            sum.add(hn::Mul(count, hn::Max(n.dot(beam), zero)), beam + 3);
        }
    }
}

/// Adds the clusters of a block and word that add up per receiver.
template<bool AnySpread>
void add_pairs(const PairWord& word, const WordLights& lights, FloatSum& result) {
    const Floats d;
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
        const Normals<Floats> n(word.normals, lane);
        Sum sum(result, lane);
        if (word.across != 0) {
            Sum whole;
            add_whole<AnySpread>(word.across, n, lights, whole);
            const auto full = hn::Set(d, static_cast<float>(prt::FullCount));
            sum.red = hn::MulAdd(full, whole.red, sum.red);
            sum.green = hn::MulAdd(full, whole.green, sum.green);
            sum.blue = hn::MulAdd(full, whole.blue, sum.blue);
        }
        add_counted<AnySpread>(word.mixed, word.counts + lane, n, lights, sum);
        sum.store(result, lane);
    }
}

void add(const FloatSum& sum, BlockLight& light) {
    const hn::CappedTag<double, prt::BlockSize> d;
    const hn::Rebind<float, decltype(d)> floats;
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
            double* total = light.mixed[channel].data() + lane;
            const auto more = hn::PromoteTo(d, hn::LoadU(floats, sum[channel].data() + lane));
            hn::StoreU(hn::Add(hn::LoadU(d, total), more), d, total);
        }
}

/// Sums the clusters of runs: a sum of all clusters before each run's end, minus a sum of those
/// before its beginning. `edges` are the bits where a run begins, which is `visible` there, or
/// ends. `prefix` begins at the word's first cluster.
void add_runs(std::uint64_t edges, std::uint64_t visible, const double* prefix, double* sum) {
    constexpr std::size_t Last = ClusterLights::Stride - 1;
    constexpr std::array<double, 2> Signs = {1.0, -1.0};
    const hn::CappedTag<double, Last> d;
    double last = sum[Last];
    for (std::size_t lane = 0; lane < Last; lane += hn::Lanes(d)) {
        auto lanes = hn::LoadU(d, sum + lane);
        for (std::uint64_t bits = edges; bits != 0; bits &= bits - 1) {
            const std::size_t i = first_bit(bits);
            const double sign = Signs[visible >> i & 1u];
            const double* before = prefix + i * ClusterLights::Stride;
            lanes = hn::MulAdd(hn::Set(d, sign), hn::LoadU(d, before + lane), lanes);
            if (lane == 0)
                last += sign * before[Last];
        }
        hn::StoreU(lanes, d, sum + lane);
    }
    sum[Last] = last;
}

void block_radiance(const BlockNormals& normals, const BlockLight& light,
                    const TracedRadiance* traced, BlockRadiance& radiance) {
    const hn::CappedTag<double, prt::BlockSize> d;
    const hn::Rebind<float, decltype(d)> floats;
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
        const auto nx = hn::PromoteTo(d, hn::LoadU(floats, normals.axes[0].data() + lane));
        const auto ny = hn::PromoteTo(d, hn::LoadU(floats, normals.axes[1].data() + lane));
        const auto nz = hn::PromoteTo(d, hn::LoadU(floats, normals.axes[2].data() + lane));
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const double* e = light.visible.data() + 3 * channel;
            const auto along_z = hn::Mul(nz, hn::Set(d, e[2]));
            const auto n_dot_e =
                hn::MulAdd(nx, hn::Set(d, e[0]), hn::MulAdd(ny, hn::Set(d, e[1]), along_z));
            const auto mixed = hn::LoadU(d, light.mixed[channel].data() + lane);
            // A whole cluster counts 16. A sum of nothing may round to a hair below zero.
            auto sum =
                hn::Max(hn::Zero(d), hn::MulAdd(hn::Set(d, static_cast<double>(prt::FullCount)),
                                                n_dot_e, mixed));
            if (traced != nullptr)
                sum = hn::Add(sum, hn::LoadU(d, traced->channels[channel].data() + lane));
            hn::StoreU(hn::DemoteTo(floats, sum), floats, radiance.channels[channel].data() + lane);
        }
    }
}

/// Calls visit(block) for the set bits, blocks of a tile.
template<class Visit>
void for_blocks(std::uint64_t bits, const Visit& visit) {
    for (; bits != 0; bits &= bits - 1)
        visit(first_bit(bits));
}

/// Returns the largest part of a block's light.
double brightness(const BlockLight& light) {
    const hn::CappedTag<double, prt::BlockSize> d;
    auto largest = hn::Zero(d);
    for (const auto& channel : light.mixed)
        for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d))
            largest = hn::Max(largest, hn::Abs(hn::LoadU(d, channel.data() + lane)));
    double result = hn::GetLane(hn::MaxOfLanes(d, largest));
    for (const double value : light.visible)
        result = std::max(result, static_cast<double>(prt::FullCount) * std::abs(value));
    return result;
}

/// Adds up the clusters that the chosen blocks of a tile see whole.
void add_visible(const BlockScene& scene, std::size_t tile, const ClusterLights& lights,
                 std::uint64_t chosen, BlockLight* of_block) {
    const prt::VisibleCounts& counts = scene.counts;
    const std::size_t begin = counts.tile_begin(tile);
    const std::size_t num_words = counts.words_per_block();
    // Side by side, because BlockLights are too far apart for the nearest cache.
    using Vector = std::array<double, ClusterLights::Stride>;
    std::array<Vector, prt::VisibleCounts::TileBlocks> sums{};
    const double* prefix = lights.prefix.data();
    std::uint64_t inside = 0; // blocks in the middle of a run
    for (std::size_t w = 0; w < num_words; ++w, prefix += 64 * ClusterLights::Stride) {
        const TileWord& blocks = scene.words.words[tile * num_words + w];
        const std::uint64_t* words = counts.visible.data() + counts.word(begin, w);
        for_blocks(blocks.edges & chosen, [&](std::size_t block) {
            const std::uint64_t visible = words[block] & ~scene.words.across_of(blocks, block);
            add_runs(visible ^ (visible << 1 | (inside >> block & 1u)), visible, prefix,
                     sums[block].data());
            inside = (inside & ~(std::uint64_t{1} << block)) | visible >> 63 << block;
        });
    }
    for_blocks(chosen, [&](std::size_t block) {
        // A run up to the last bit of the last word ends behind it.
        add_runs(inside >> block & 1u, 0, prefix, sums[block].data());
        of_block[block].visible = sums[block];
    });
}

/// Adds up the clusters that the chosen blocks of a tile see in part or across a horizon.
void add_per_receiver(const BlockScene& scene, std::size_t tile, const ClusterLights& lights,
                      std::uint64_t chosen, BlockLight* of_block) {
    // So many words add up in float.
    constexpr std::size_t FloatWords = 8;
    const prt::VisibleCounts& counts = scene.counts;
    const std::size_t begin = counts.tile_begin(tile);
    const std::size_t num_words = counts.words_per_block();
    std::array<FloatSum, prt::VisibleCounts::TileBlocks> sums{};
    std::uint64_t summed = 0;
    for (std::size_t w = 0; w < num_words; ++w) {
        const TileWord& blocks = scene.words.words[tile * num_words + w];
        const std::size_t first_word = counts.word(begin, w);
        const WordLights of_word{.vectors = lights.vectors.data() + w * 64 * ClusterLights::Stride,
                                 .beams = lights.beams.data() + w * 64 * ClusterLights::BeamStride,
                                 .spread = lights.spread[w]};
        const std::uint64_t pairs = (blocks.mixed | blocks.across) & chosen;
        for_blocks(pairs, [&](std::size_t block) {
            const PairWord word{
                counts.mixed[first_word + block], scene.words.across_of(blocks, block),
                counts.mixed_counts(first_word + block, 0), scene.normals[begin + block]};
            if (((word.mixed | word.across) & of_word.spread) != 0)
                add_pairs<true>(word, of_word, sums[block]);
            else
                add_pairs<false>(word, of_word, sums[block]);
        });
        summed |= pairs;
        if (w % FloatWords == FloatWords - 1 || w == num_words - 1) {
            for_blocks(summed, [&](std::size_t block) {
                add(sums[block], of_block[block]);
                sums[block] = {};
            });
            summed = 0;
        }
    }
}

void light_tile(const BlockScene& scene, std::size_t tile, const ClusterLights& lights,
                BlockLight* light, std::uint64_t chosen) {
    const std::size_t begin = scene.counts.tile_begin(tile);
    chosen &= scene.counts.tile_blocks(tile);
    for_blocks(chosen, [&](std::size_t block) { light[begin + block] = {}; });
    add_visible(scene, tile, lights, chosen, light + begin);
    add_per_receiver(scene, tile, lights, chosen, light + begin);
    for_blocks(chosen, [&](std::size_t block) {
        light[begin + block].summed = brightness(light[begin + block]);
        light[begin + block].largest = light[begin + block].summed;
    });
}

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

/// Adds the changes of a word's clusters to what adds up per receiver.
void change_pairs(const PairWord& word, const LightChanges& changes, const ChangedWord& change,
                  BlockLight& light) {
    const Floats d;
    const auto zero = hn::Zero(d);
    const auto full = hn::Set(d, static_cast<float>(prt::FullCount));
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
        const Normals<Floats> n(word.normals, lane);
        DoubleSum red(light.mixed[0].data() + lane);
        DoubleSum green(light.mixed[1].data() + lane);
        DoubleSum blue(light.mixed[2].data() + lane);
        for (std::uint64_t bits = (word.mixed | word.across) & change.clusters; bits != 0;
             bits &= bits - 1) {
            const std::uint64_t before = (bits & (~bits + 1)) - 1;
            const std::size_t cluster =
                change.first + static_cast<std::size_t>(std::popcount(change.clusters & before));
            const bool is_mixed = (word.mixed & (before + 1)) != 0;
            const std::uint8_t* counts =
                word.counts +
                static_cast<std::size_t>(std::popcount(word.mixed & before)) * prt::BlockSize;
            const auto count = is_mixed ? load_counts(d, counts + lane) : full;
            for (std::size_t i = changes.beams_before[cluster];
                 i < changes.beams_before[cluster + 1]; ++i) {
                const BeamChange& beam = changes.beams[i];
                const auto cosine = n.dot(beam.direction.data());
                const DoubleSum::Part part(hn::Mul(count, hn::Max(cosine, zero)));
                red.add(part, beam.colour[0]);
                green.add(part, beam.colour[1]);
                blue.add(part, beam.colour[2]);
            }
        }
        red.store(light.mixed[0].data() + lane);
        green.store(light.mixed[1].data() + lane);
        blue.store(light.mixed[2].data() + lane);
    }
}

void add(const std::array<double, ClusterLights::Stride>& vector,
         std::array<double, ClusterLights::Stride>& sum) {
    constexpr std::size_t Last = ClusterLights::Stride - 1;
    const hn::CappedTag<double, Last> d;
    for (std::size_t lane = 0; lane < Last; lane += hn::Lanes(d))
        hn::StoreU(hn::Add(hn::LoadU(d, sum.data() + lane), hn::LoadU(d, vector.data() + lane)), d,
                   sum.data() + lane);
    sum[Last] += vector[Last];
}

std::uint64_t update_tile(const BlockScene& scene, std::size_t tile, const LightChanges& changes,
                          BlockLight* light) {
    const prt::VisibleCounts& counts = scene.counts;
    const std::size_t begin = counts.tile_begin(tile);
    BlockLight* of_block = light + begin;
    std::uint64_t touched = 0;
    for (const ChangedWord& change : changes.words) {
        const TileWord& blocks = scene.words.words[tile * counts.words_per_block() + change.word];
        const std::size_t first_word = counts.word(begin, change.word);
        // Most blocks that see one changed cluster whole see all of them, because these are
        // neighbours in the sky.
        for_blocks(blocks.visible, [&](std::size_t block) {
            const std::uint64_t seen = counts.visible[first_word + block] &
                                       ~scene.words.across_of(blocks, block) & change.clusters;
            if (seen == 0)
                return;
            touched |= std::uint64_t{1} << block;
            if (seen == change.clusters)
                add(change.vector, of_block[block].visible);
            else
                for (std::uint64_t bits = seen; bits != 0; bits &= bits - 1)
                    add(changes.vectors[change.first +
                                        static_cast<std::size_t>(std::popcount(
                                            change.clusters & ((bits & (~bits + 1)) - 1)))],
                        of_block[block].visible);
        });
        // The counts lie far apart: they are asked for before the first is needed.
        std::uint64_t hit = 0;
        for_blocks(blocks.mixed | blocks.across, [&](std::size_t block) {
            const std::uint64_t mixed = counts.mixed[first_word + block] & change.clusters;
            if ((mixed | (scene.words.across_of(blocks, block) & change.clusters)) == 0)
                return;
            hit |= std::uint64_t{1} << block;
            if (mixed != 0)
                hwy::Prefetch(counts.mixed_counts(first_word + block,
                                                  static_cast<std::uint32_t>(first_bit(mixed))));
        });
        touched |= hit;
        for_blocks(hit, [&](std::size_t block) {
            const std::size_t word = first_word + block;
            change_pairs({counts.mixed[word], scene.words.across_of(blocks, block),
                          counts.mixed_counts(word, 0), scene.normals[begin + block]},
                         changes, change, of_block[block]);
        });
    }
    return touched;
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

namespace {
HWY_EXPORT(block_radiance);
HWY_EXPORT(brightness);
HWY_EXPORT(light_tile);
HWY_EXPORT(update_tile);
} // namespace

ClusterLights::ClusterLights(std::size_t num_clusters)
    : vectors(num_clusters * Stride), beams(num_clusters * BeamStride),
      spread((num_clusters + 63) / 64), prefix((spread.size() * 64 + 1) * Stride) {}

void ClusterLights::set(std::size_t cluster, const VectorIrradiance& irradiance) {
    constexpr double Scale = 1.0 / (16.0 * std::numbers::pi);
    const std::array<glm::vec3, 3> channels = {glm::vec3(irradiance.red * Scale),
                                               glm::vec3(irradiance.green * Scale),
                                               glm::vec3(irradiance.blue * Scale)};
    float* vector = vectors.data() + cluster * Stride;
    float* beam = beams.data() + cluster * BeamStride;
    for (const glm::vec3& channel : channels)
        for (int axis = 0; axis < 3; ++axis)
            *vector++ = channel[axis];

    const glm::dvec3 luminance = irradiance.luminance();
    const double length = glm::length(luminance);
    const glm::vec3 direction = length > 0.0 ? glm::vec3(luminance / length) : glm::vec3(0.0f);
    const double per_square =
        length > 0.0 ? 1.0 / glm::dot(glm::dvec3(direction), glm::dvec3(direction)) : 0.0;
    double off = 0.0, all = 0.0;
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 channel(channels[static_cast<std::size_t>(i)]);
        const double colour = glm::dot(channel, glm::dvec3(direction)) * per_square;
        const glm::dvec3 rest = channel - colour * glm::dvec3(direction);
        off += glm::dot(rest, rest);
        all += glm::dot(channel, channel);
        beam[i] = direction[i];
        beam[3 + i] = static_cast<float>(colour);
    }
    const std::uint64_t bit = std::uint64_t{1} << (cluster % 64);
    if (off > BeamTolerance * BeamTolerance * all)
        spread[cluster / 64] |= bit;
    else
        spread[cluster / 64] &= ~bit;
}

void ClusterLights::sum_prefix() {
    for (std::size_t i = 0; i < vectors.size(); ++i)
        prefix[i + Stride] = prefix[i] + static_cast<double>(vectors[i]);
}

glm::dvec3 ClusterLights::of_vectors(std::size_t cluster, const glm::vec3& normal) const {
    const float* vector = vectors.data() + cluster * Stride;
    const auto on = [&](const float* e) {
        return std::max(0.0, glm::dot(glm::dvec3(normal), glm::dvec3(e[0], e[1], e[2])));
    };
    return {on(vector), on(vector + 3), on(vector + 6)};
}

glm::dvec3 ClusterLights::of_beams(std::size_t cluster, const glm::vec3& normal) const {
    if (is_spread(cluster))
        return of_vectors(cluster, normal);
    const float* beam = beams.data() + cluster * BeamStride;
    return std::max(0.0, glm::dot(glm::dvec3(normal), glm::dvec3(beam[0], beam[1], beam[2]))) *
           glm::dvec3(beam[3], beam[4], beam[5]);
}

void LightChanges::clear() {
    words.clear();
    vectors.clear();
    beams_before.resize(1);
    beams.clear();
}

void LightChanges::set(ClusterLights& lights, std::size_t cluster,
                       const VectorIrradiance& irradiance) {
    struct Light {
        std::array<float, ClusterLights::Stride> vector;
        std::array<float, ClusterLights::BeamStride> beam;
        bool is_spread;
        bool operator==(const Light&) const = default;

        Light(const ClusterLights& all, std::size_t c) : is_spread(all.is_spread(c)) {
            std::copy_n(all.vectors.begin() + static_cast<std::ptrdiff_t>(c * vector.size()),
                        vector.size(), vector.begin());
            std::copy_n(all.beams.begin() + static_cast<std::ptrdiff_t>(c * beam.size()),
                        beam.size(), beam.begin());
        }
    };
    const Light before(lights, cluster);
    lights.set(cluster, irradiance);
    const Light after(lights, cluster);
    if (before == after)
        return;

    if (words.empty() || words.back().word != cluster / 64)
        words.push_back({.word = static_cast<std::uint32_t>(cluster / 64),
                         .first = static_cast<std::uint32_t>(vectors.size())});
    words.back().clusters |= std::uint64_t{1} << (cluster % 64);
    std::array<double, ClusterLights::Stride>& change = vectors.emplace_back();
    for (std::size_t i = 0; i < change.size(); ++i) {
        change[i] = static_cast<double>(after.vector[i]) - static_cast<double>(before.vector[i]);
        words.back().vector[i] += change[i];
    }

    const auto add = [&](const Light& light, double sign) {
        const auto& v = light.vector;
        if (light.is_spread) {
            beams.push_back({.direction = {v[0], v[1], v[2]}, .colour = {sign, 0.0, 0.0}});
            beams.push_back({.direction = {v[3], v[4], v[5]}, .colour = {0.0, sign, 0.0}});
            beams.push_back({.direction = {v[6], v[7], v[8]}, .colour = {0.0, 0.0, sign}});
        } else {
            beams.push_back({.direction = {light.beam[0], light.beam[1], light.beam[2]},
                             .colour = {sign * static_cast<double>(light.beam[3]),
                                        sign * static_cast<double>(light.beam[4]),
                                        sign * static_cast<double>(light.beam[5])}});
        }
    };
    add(before, -1.0);
    add(after, 1.0);
    // One beam instead of two where only the colour changes.
    BeamChange& last = beams.back();
    if (!before.is_spread && !after.is_spread && beams.end()[-2].direction == last.direction) {
        for (std::size_t i = 0; i < 3; ++i)
            last.colour[i] += beams.end()[-2].colour[i];
        beams.erase(beams.end() - 2);
    }
    beams_before.push_back(static_cast<std::uint32_t>(beams.size()));
}

bool has_dimmed(BlockLight& light) {
    const double now = HWY_DYNAMIC_DISPATCH(brightness)(light);
    light.largest = std::max(light.largest, now);
    return now < light.summed / 64.0 || now < std::ldexp(light.largest, -30);
}

void block_radiance(const BlockNormals& normals, const BlockLight& light,
                    const TracedRadiance* traced, BlockRadiance& radiance) {
    HWY_DYNAMIC_DISPATCH(block_radiance)(normals, light, traced, radiance);
}

void light_tile(const BlockScene& scene, std::size_t tile, const ClusterLights& lights,
                std::span<BlockLight> light, std::uint64_t blocks) {
    HWY_DYNAMIC_DISPATCH(light_tile)(scene, tile, lights, light.data(), blocks);
}

std::uint64_t update_tile(const BlockScene& scene, std::size_t tile, const LightChanges& changes,
                          std::span<BlockLight> light) {
    return HWY_DYNAMIC_DISPATCH(update_tile)(scene, tile, changes, light.data());
}

} // namespace relumine::relight
#endif // HWY_ONCE
