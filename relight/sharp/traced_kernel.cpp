#include "relight/sharp/traced_kernel.h"

#include <array>
#include <cstddef>
#include <numbers>

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/sharp/traced_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "prt/visibility/mask_bits-inl.h"
#include "relight/kernels/block_loops-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Receivers whose bits are looked up together.
constexpr std::size_t NibbleSize = 4;

/// [bits][receiver] 1 where the bit is set.
constexpr std::array<std::array<double, NibbleSize>, 16> parts_of_bits() {
    std::array<std::array<double, NibbleSize>, 16> parts{};
    for (std::size_t bits = 0; bits < parts.size(); ++bits)
        for (std::size_t i = 0; i < NibbleSize; ++i)
            parts[bits][i] = (bits >> i & 1u) != 0 ? 1.0 : 0.0;
    return parts;
}
constexpr std::array<std::array<double, NibbleSize>, 16> PartsOfBits = parts_of_bits();

std::uint32_t lanes_above(const BlockNormals& normals, const glm::vec3& direction) {
    const Floats d;
    std::uint32_t above = 0;
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
        const auto cosine = Normals<Floats>(normals, lane).dot(&direction.x);
        above |= prt::HWY_NAMESPACE::bits_of(d, hn::Gt(cosine, hn::Zero(d))) << lane;
    }
    return above;
}

void traced_radiance(const BlockNormals& normals, std::span<const ReachingLight> lights,
                     TracedRadiance& radiance) {
    const hn::CappedTag<double, NibbleSize> d;
    const hn::Rebind<float, decltype(d)> floats;
    const auto zero = hn::Set(d, 0.0);
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
        const auto x = hn::PromoteTo(d, hn::LoadU(floats, normals.axes[0].data() + lane));
        const auto y = hn::PromoteTo(d, hn::LoadU(floats, normals.axes[1].data() + lane));
        const auto z = hn::PromoteTo(d, hn::LoadU(floats, normals.axes[2].data() + lane));
        const std::size_t nibble = lane / NibbleSize * NibbleSize;
        auto red = zero, green = zero, blue = zero;
        for (const ReachingLight& light : lights) {
            const auto& parts = PartsOfBits[light.reached >> nibble & 0xfu];
            const auto part = hn::LoadU(d, parts.data() + (lane - nibble));
            const auto on = [&](const glm::dvec3& of) {
                return hn::Mul(part,
                               hn::Max(zero, hn::MulAdd(hn::Set(d, of.x), x,
                                                        hn::MulAdd(hn::Set(d, of.y), y,
                                                                   hn::Mul(hn::Set(d, of.z), z)))));
            };
            red = hn::Add(red, on(light.irradiance->red));
            green = hn::Add(green, on(light.irradiance->green));
            blue = hn::Add(blue, on(light.irradiance->blue));
        }
        const auto over_pi = hn::Set(d, std::numbers::inv_pi);
        hn::Store(hn::Mul(red, over_pi), d, radiance.channels[0].data() + lane);
        hn::Store(hn::Mul(green, over_pi), d, radiance.channels[1].data() + lane);
        hn::Store(hn::Mul(blue, over_pi), d, radiance.channels[2].data() + lane);
    }
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

namespace {
HWY_EXPORT(lanes_above);
HWY_EXPORT(traced_radiance);
} // namespace

std::uint32_t lanes_above(const BlockNormals& normals, const glm::vec3& direction) {
    return HWY_DYNAMIC_DISPATCH(lanes_above)(normals, direction);
}

TracedRadiance traced_radiance(const BlockNormals& normals, std::span<const ReachingLight> lights) {
    TracedRadiance radiance;
    HWY_DYNAMIC_DISPATCH(traced_radiance)(normals, lights, radiance);
    return radiance;
}

} // namespace relumine::relight
#endif
