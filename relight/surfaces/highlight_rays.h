// How many rays find a highlight. What a user asks for is the number of a pixel; who sends rays for
// something else, or finds a lobe that needs more, has his share of that from here.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>

#include "prt/glossy/brdf.h"
#include "prt/glossy/sheen_lobe.h"
#include "relight/surfaces/reflections.h"

namespace relumine::relight {

/// The part of its share of the lobe over which a ray sees the mean. Over all of it, 32 rays of a
/// rough metal under lamps were 9 of 255 brighter than many rays.
inline constexpr float SeenShare = 0.5f;

/// Rays of the whole lobe of a surface, and of its coat and its sheen, where a highlight has `num`.
/// Wide lobes, over which the weights of rays differ, stretched ones and sheen take twice as many.
struct LobeRays {
    LobeRays(const prt::Surface& surface, std::uint32_t num)
        : all(lobe_alpha(surface) > WideAlpha || prt::is_stretched(surface) ? 2 * num : num),
          coat((num + 1) / 2), sheen(2 * num) {}
    /// One ray of as many.
    static LobeRays one_of(std::uint32_t num, std::uint32_t ray) {
        LobeRays one;
        one.all = one.coat = one.sheen = num;
        one.only = ray;
        return one;
    }
    static constexpr float WideAlpha = 0.25f;
    std::uint32_t all, coat;
    /// They are as dense everywhere.
    std::uint32_t sheen;
    /// The number of one ray that is sent alone.
    std::optional<std::uint32_t> only;

private:
    LobeRays() = default;
};

/// Returns the rays of a pixel that shares none with its neighbours. One of several normals adds
/// half.
[[nodiscard]] inline std::uint32_t rays_of_pixel(std::uint32_t num, bool is_first) {
    return is_first ? num : (num + 1) / 2;
}

/// Returns the rays that go on through rough glass.
[[nodiscard]] inline std::uint32_t rays_through_glass(std::uint32_t num) {
    return (num + 3) / 4;
}

/// Returns the rays of a receiver, which shares none: those of a narrow lobe go one way, of sheen
/// all. `shown` is the part of a pixel that it fills. A power of two: the lobe can be parted.
[[nodiscard]] inline std::uint32_t rays_of_receiver(const prt::Surface& surface, std::uint32_t num,
                                                    float shown) {
    constexpr float WideFrom = 0.1f;
    constexpr std::uint32_t Least = 4;
    float part = 1.0f;
    if (prt::has_sheen(surface) || prt::is_stretched(surface))
        part = 2.0f;
    else if (prt::facts_of(surface.highlight).is_roughness && !prt::has_coat(surface))
        part = std::min(surface.roughness_or_exponent / WideFrom, 1.0f);
    const float rays = static_cast<float>(num) * part * shown;
    return std::bit_ceil(std::max(static_cast<std::uint32_t>(std::ceil(rays)), Least));
}

} // namespace relumine::relight
