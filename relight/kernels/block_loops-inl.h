// What the kernels that light blocks share. Compiled once per instruction set, inside a Highway
// block.
#if defined(RELUMINE_RELIGHT_BLOCK_LOOPS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RELUMINE_RELIGHT_BLOCK_LOOPS_INL_H
#undef RELUMINE_RELIGHT_BLOCK_LOOPS_INL_H
#else
#define RELUMINE_RELIGHT_BLOCK_LOOPS_INL_H
#endif

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "files/wasm_doubles-inl.h"
#include "relight/kernels/block_kernels.h"

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
HWY_INLINE hn::Vec<D> load_counts(D d, const std::uint8_t* counts) {
    const hn::Rebind<std::uint8_t, D> bytes;
    const hn::Rebind<std::int32_t, D> integers;
    return hn::ConvertTo(d, hn::PromoteTo(integers, hn::LoadU(bytes, counts)));
}

HWY_INLINE std::size_t first_bit(std::uint64_t bits) {
    return static_cast<std::size_t>(std::countr_zero(bits));
}

/// Returns how many counts the mixed pairs of a word have.
HWY_INLINE std::size_t num_counts(std::uint64_t mixed) {
    return static_cast<std::size_t>(std::popcount(mixed)) * prt::BlockSize;
}

/// Calls visit(block) for the set bits, blocks of a tile.
template<class Visit>
HWY_INLINE void for_blocks(std::uint64_t bits, const Visit& visit) {
    for (; bits != 0; bits &= bits - 1)
        visit(first_bit(bits));
}

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

/// The light of a word's clusters, in one environment.
struct WordLights {
    const float* vectors;
    const float* directionals;
    std::uint64_t spread;

    WordLights() = default;
    WordLights(const ClusterLights& lights, std::size_t w)
        : vectors(lights.vectors.data() + w * 64 * ClusterLights::Stride),
          directionals(lights.directionals.data() + w * 64 * ClusterLights::DirectionalStride),
          spread(lights.spread[w]) {}
};

/// Adds max(n.E, 0) of cluster i of a word. Without AnySpread it is not spread.
template<bool AnySpread>
HWY_INLINE void add_cluster(const WordLights& lights, std::size_t i, const Normals<Floats>& n,
                            Sum& sum) {
    const auto zero = hn::Zero(Floats());
    if (AnySpread && (lights.spread >> i & 1u) != 0) {
        const float* e = lights.vectors + i * ClusterLights::Stride;
        sum.red = hn::Add(sum.red, hn::Max(n.dot(e), zero));
        sum.green = hn::Add(sum.green, hn::Max(n.dot(e + 3), zero));
        sum.blue = hn::Add(sum.blue, hn::Max(n.dot(e + 6), zero));
    } else {
        const float* directional = lights.directionals + i * ClusterLights::DirectionalStride;
        sum.add(hn::Max(n.dot(directional), zero), directional + 3);
    }
}

/// Adds float sums to those in double.
HWY_INLINE void add(const FloatSum& sum, BlockLight& light) {
    const hn::CappedTag<double, prt::BlockSize> d;
    const hn::Rebind<float, decltype(d)> floats;
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
            double* total = light.mixed[channel].data() + lane;
            const auto more = hn::PromoteTo(d, hn::LoadU(floats, sum[channel].data() + lane));
            hn::StoreU(hn::Add(hn::LoadU(d, total), more), d, total);
        }
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif // toggle
