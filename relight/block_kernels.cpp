#include "relight/block_kernels.h"

#include <algorithm>
#include <bit>
#include <numbers>

#include "prt/clusters/lattice.h"

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

    /// Returns max(n.e, 0).
    [[nodiscard]] FloatVec cosine(const float* e) const {
        const Floats d;
        const auto along_z = hn::Mul(z, hn::Set(d, e[2]));
        const auto n_dot_e =
            hn::MulAdd(x, hn::Set(d, e[0]), hn::MulAdd(y, hn::Set(d, e[1]), along_z));
        return hn::Max(n_dot_e, hn::Zero(d));
    }
};

FloatVec load_counts(const std::uint8_t* counts) {
    const Floats d;
    const hn::Rebind<std::uint8_t, Floats> bytes;
    const hn::Rebind<std::int32_t, Floats> integers;
    return hn::ConvertTo(d, hn::PromoteTo(integers, hn::LoadU(bytes, counts)));
}

/// Radiance of some receivers, per channel.
struct Sum {
    FloatVec red, green, blue;

    // Written out: g++ compiles an implicit constructor without the instruction set of the
    // functions around it.
    Sum() : red(hn::Zero(Floats())), green(red), blue(red) {}

    /// Adds max(n.E, 0).
    void add_clamped(const Normals& n, const float* e) {
        add(n.cosine(e), n.cosine(e + 3), n.cosine(e + 6));
    }

    void add(FloatVec r, FloatVec g, FloatVec b) {
        red = hn::Add(red, r);
        green = hn::Add(green, g);
        blue = hn::Add(blue, b);
    }

    /// Gives all that was added so far the count of a whole cluster.
    void count_full() {
        const auto full = hn::Set(Floats(), static_cast<float>(prt::FullCount));
        red = hn::Mul(red, full);
        green = hn::Mul(green, full);
        blue = hn::Mul(blue, full);
    }

    /// Adds c max(n.E, 0).
    void add_clamped(FloatVec count, const Normals& n, const float* e) {
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

/// The sum of c E over clusters, per channel and axis, where no receiver needs the clamp.
struct VectorSum {
    FloatVec red_x, red_y, red_z, green_x, green_y, green_z, blue_x, blue_y, blue_z;

    VectorSum()
        : red_x(hn::Zero(Floats())), red_y(red_x), red_z(red_x), green_x(red_x), green_y(red_x),
          green_z(red_x), blue_x(red_x), blue_y(red_x), blue_z(red_x) {}

    void add(FloatVec count, const float* e) {
        const Floats d;
        red_x = hn::MulAdd(count, hn::Set(d, e[0]), red_x);
        red_y = hn::MulAdd(count, hn::Set(d, e[1]), red_y);
        red_z = hn::MulAdd(count, hn::Set(d, e[2]), red_z);
        green_x = hn::MulAdd(count, hn::Set(d, e[3]), green_x);
        green_y = hn::MulAdd(count, hn::Set(d, e[4]), green_y);
        green_z = hn::MulAdd(count, hn::Set(d, e[5]), green_z);
        blue_x = hn::MulAdd(count, hn::Set(d, e[6]), blue_x);
        blue_y = hn::MulAdd(count, hn::Set(d, e[7]), blue_y);
        blue_z = hn::MulAdd(count, hn::Set(d, e[8]), blue_z);
    }

    /// Returns n . sum.
    [[nodiscard]] Sum on(const Normals& n) const {
        Sum sum;
        sum.red = hn::MulAdd(n.x, red_x, hn::MulAdd(n.y, red_y, hn::Mul(n.z, red_z)));
        sum.green = hn::MulAdd(n.x, green_x, hn::MulAdd(n.y, green_y, hn::Mul(n.z, green_z)));
        sum.blue = hn::MulAdd(n.x, blue_x, hn::MulAdd(n.y, blue_y, hn::Mul(n.z, blue_z)));
        return sum;
    }
};

std::size_t first_float(std::uint64_t bits) {
    return static_cast<std::size_t>(std::countr_zero(bits)) * ClusterLights::Stride;
}

/// The clusters of a block and word that add up per receiver.
struct MixedWord {
    /// Seen in part.
    std::uint64_t mixed;
    /// Seen whole, across a horizon.
    std::uint64_t across;
    /// Begins at the first entry of `mixed`.
    const std::uint8_t* counts;
    const BlockNormals& normals;
};

/// Sums c max(n.E, 0) over the word's clusters. `vectors` begins at the word's first cluster.
void sum_clamped(const MixedWord& word, const float* vectors, WordSum& result) {
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(Floats())) {
        const Normals n(word.normals, lane);
        Sum sum;
        for (std::uint64_t bits = word.across; bits != 0; bits &= bits - 1)
            sum.add_clamped(n, vectors + first_float(bits));
        sum.count_full();
        const std::uint8_t* counts = word.counts + lane;
        for (std::uint64_t bits = word.mixed; bits != 0; bits &= bits - 1, counts += prt::BlockSize)
            sum.add_clamped(load_counts(counts), n, vectors + first_float(bits));
        sum.store(result, lane);
    }
}

/// Sums c n.E over the word's clusters, where the clamp can be left out.
void sum_unclamped(const MixedWord& word, const float* vectors, WordSum& result) {
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(Floats())) {
        VectorSum sum;
        const std::uint8_t* counts = word.counts + lane;
        for (std::uint64_t bits = word.mixed; bits != 0; bits &= bits - 1, counts += prt::BlockSize)
            sum.add(load_counts(counts), vectors + first_float(bits));
        sum.on(Normals(word.normals, lane)).store(result, lane);
    }
}

/// Does sum_clamped() with two sets of vectors at once. They differ in `changed` clusters only.
void sum_clamped_twice(const MixedWord& word, std::uint64_t changed, const float* before,
                       const float* after, WordSum& result_before, WordSum& result_after) {
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(Floats())) {
        const Normals n(word.normals, lane);
        Sum sum_before;
        Sum sum_after;
        for (std::uint64_t bits = word.across; bits != 0; bits &= bits - 1) {
            const float* e = before + first_float(bits);
            const auto red = n.cosine(e), green = n.cosine(e + 3), blue = n.cosine(e + 6);
            sum_before.add(red, green, blue);
            if ((changed & bits & (~bits + 1)) == 0)
                sum_after.add(red, green, blue);
            else
                sum_after.add_clamped(n, after + first_float(bits));
        }
        sum_before.count_full();
        sum_after.count_full();
        const std::uint8_t* counts = word.counts + lane;
        for (std::uint64_t bits = word.mixed; bits != 0;
             bits &= bits - 1, counts += prt::BlockSize) {
            const auto count = load_counts(counts);
            const float* e = before + first_float(bits);
            const auto red = n.cosine(e), green = n.cosine(e + 3), blue = n.cosine(e + 6);
            sum_before.add(count, red, green, blue);
            if ((changed & bits & (~bits + 1)) == 0)
                sum_after.add(count, red, green, blue);
            else
                sum_after.add_clamped(count, n, after + first_float(bits));
        }
        sum_before.store(result_before, lane);
        sum_after.store(result_after, lane);
    }
}

void add(const WordSum& sum, BlockLight& light) {
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (std::size_t i = 0; i < prt::BlockSize; ++i)
            light.mixed[channel][i] += static_cast<double>(sum[channel][i]);
}

void add_difference(const WordSum& before, const WordSum& after, BlockLight& light) {
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (std::size_t i = 0; i < prt::BlockSize; ++i)
            light.mixed[channel][i] +=
                static_cast<double>(after[channel][i]) - static_cast<double>(before[channel][i]);
}

/// Adds the clusters of the set bits: one difference of prefix sums for each run of them. `prefix`
/// begins at the word's first cluster.
void add_runs(std::uint64_t bits, const double* prefix, double* sum) {
    const hn::CappedTag<double, ClusterLights::Stride - 1> d;
    for (std::size_t lane = 0; lane < ClusterLights::Stride - 1; lane += hn::Lanes(d)) {
        auto lanes = hn::LoadU(d, sum + lane);
        double last = 0.0;
        for (std::uint64_t rest = bits; rest != 0;) {
            const std::size_t first = first_float(rest);
            rest += rest & (~rest + 1); // the run carries into the zero above it, if there is one
            const std::size_t end = rest == 0 ? 64 * ClusterLights::Stride : first_float(rest);
            rest &= bits;
            lanes = hn::Add(lanes, hn::Sub(hn::LoadU(d, prefix + end + lane),
                                           hn::LoadU(d, prefix + first + lane)));
            last +=
                prefix[end + ClusterLights::Stride - 1] - prefix[first + ClusterLights::Stride - 1];
        }
        hn::StoreU(lanes, d, sum + lane);
        if (lane == 0)
            sum[ClusterLights::Stride - 1] += last;
    }
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

/// Calls visit(block, word) for the set bits. `word` belongs to the tile's first block.
template<class Visit>
void for_blocks(std::uint64_t bits, std::size_t begin, std::size_t word, const Visit& visit) {
    for (; bits != 0; bits &= bits - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(bits));
        visit(begin + i, word + i);
    }
}

void light_tile(const BlockScene& scene, std::size_t tile, const ClusterLights& lights,
                BlockLight* light) {
    const prt::VisibleCounts& counts = scene.counts;
    const std::size_t begin = counts.tile_begin(tile);
    const std::size_t end = counts.tile_begin(tile + 1);
    std::fill(light + begin, light + end, BlockLight{});
    for (std::size_t w = 0; w < counts.words_per_block(); ++w) {
        const TileWord& blocks = scene.words.words[tile * counts.words_per_block() + w];
        const std::size_t first_word = counts.word(begin, w);
        const float* vectors = lights.vectors.data() + w * 64 * ClusterLights::Stride;
        const double* prefix = lights.prefix.data() + w * 64 * ClusterLights::Stride;
        const auto mixed = [&](std::size_t block, std::size_t word, std::uint64_t across) {
            return MixedWord{counts.mixed[word], across, counts.mixed_counts(word, 0),
                             scene.normals[block]};
        };
        const auto add_clamped = [&](const MixedWord& word, std::size_t block) {
            WordSum sum;
            sum_clamped(word, vectors, sum);
            add(sum, light[block]);
        };
        const std::uint64_t* across = scene.words.across.data() + blocks.across_before;
        for_blocks(blocks.across, begin, first_word, [&](std::size_t block, std::size_t word) {
            if (const std::uint64_t above = counts.visible[word] & ~*across; above != 0)
                add_runs(above, prefix, light[block].visible.data());
            add_clamped(mixed(block, word, *across++), block);
        });
        for_blocks(blocks.visible & ~blocks.across, begin, first_word,
                   [&](std::size_t block, std::size_t word) {
                       add_runs(counts.visible[word], prefix, light[block].visible.data());
                   });
        for_blocks(blocks.clamped & ~blocks.across, begin, first_word,
                   [&](std::size_t block, std::size_t word) {
                       add_clamped(mixed(block, word, 0), block);
                   });
        for_blocks(blocks.unclamped, begin, first_word, [&](std::size_t block, std::size_t word) {
            WordSum sum;
            sum_unclamped(mixed(block, word, 0), vectors, sum);
            add(sum, light[block]);
        });
    }
}

/// The change of some clusters' vectors, summed over these clusters of a word.
class VectorDifference {
public:
    VectorDifference(std::uint64_t clusters, const float* before, const float* after) {
        for (; clusters != 0; clusters &= clusters - 1) {
            const std::size_t first = first_float(clusters);
            for (std::size_t i = 0; i < ClusterLights::Stride; ++i)
                sum_[i] +=
                    static_cast<double>(after[first + i]) - static_cast<double>(before[first + i]);
        }
    }

    void add_to(std::array<double, ClusterLights::Stride>& vector) const {
        for (std::size_t i = 0; i < ClusterLights::Stride; ++i)
            vector[i] += sum_[i];
    }

private:
    std::array<double, ClusterLights::Stride> sum_{};
};

std::uint64_t update_tile(const BlockScene& scene, std::size_t tile,
                          std::span<const ChangedWord> changes, const float* all_before,
                          const float* all_after, BlockLight* light) {
    const prt::VisibleCounts& counts = scene.counts;
    const std::size_t begin = counts.tile_begin(tile);
    std::uint64_t touched = 0;
    for (const ChangedWord& change : changes) {
        const TileWord& blocks = scene.words.words[tile * counts.words_per_block() + change.word];
        const std::size_t first_word = counts.word(begin, change.word);
        const float* before = all_before + std::size_t{change.word} * 64 * ClusterLights::Stride;
        const float* after = all_after + std::size_t{change.word} * 64 * ClusterLights::Stride;
        // Most blocks that see one changed cluster whole see all of them, because these are
        // neighbours in the sky.
        const VectorDifference all(change.clusters, before, after);
        for_blocks(blocks.visible, begin, first_word, [&](std::size_t block, std::size_t word) {
            const std::uint64_t seen = counts.visible[word] &
                                       ~scene.words.across_of(blocks, block - begin) &
                                       change.clusters;
            if (seen == 0)
                return;
            touched |= std::uint64_t{1} << (block - begin);
            if (seen == change.clusters)
                all.add_to(light[block].visible);
            else
                VectorDifference(seen, before, after).add_to(light[block].visible);
        });
        for_blocks(blocks.clamped | blocks.unclamped, begin, first_word,
                   [&](std::size_t block, std::size_t word) {
                       const MixedWord mixed{counts.mixed[word],
                                             scene.words.across_of(blocks, block - begin),
                                             counts.mixed_counts(word, 0), scene.normals[block]};
                       if (((mixed.mixed | mixed.across) & change.clusters) == 0)
                           return;
                       touched |= std::uint64_t{1} << (block - begin);
                       WordSum sum_before;
                       WordSum sum_after;
                       if ((blocks.clamped >> (block - begin) & 1u) != 0) {
                           sum_clamped_twice(mixed, change.clusters, before, after, sum_before,
                                             sum_after);
                       } else {
                           sum_unclamped(mixed, before, sum_before);
                           sum_unclamped(mixed, after, sum_after);
                       }
                       add_difference(sum_before, sum_after, light[block]);
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

void block_radiance(const BlockNormals& normals, const BlockLight& light,
                    const TracedRadiance* traced, BlockRadiance& radiance) {
    HWY_DYNAMIC_DISPATCH(block_radiance)(normals, light, traced, radiance);
}

void light_tile(const BlockScene& scene, std::size_t tile, const ClusterLights& lights,
                std::span<BlockLight> light) {
    HWY_DYNAMIC_DISPATCH(light_tile)(scene, tile, lights, light.data());
}

std::uint64_t update_tile(const BlockScene& scene, std::size_t tile,
                          std::span<const ChangedWord> changes, std::span<const float> before,
                          std::span<const float> after, std::span<BlockLight> light) {
    return HWY_DYNAMIC_DISPATCH(update_tile)(scene, tile, changes, before.data(), after.data(),
                                             light.data());
}

} // namespace relumine::relight
#endif // HWY_ONCE
