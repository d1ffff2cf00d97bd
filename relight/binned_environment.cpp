#include "relight/binned_environment.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "files/parallel.h"

namespace relumine::relight {

namespace {

bool is_good(const glm::vec3& texel) {
    // NaN fails both comparisons.
    const auto good = [](float value) {
        return value >= 0.0f && value <= MaxRadiance;
    };
    return good(texel.r) && good(texel.g) && good(texel.b);
}

/// Whether all values are surely good. (-0 is good, but not surely.) As whole numbers, floats from
/// 0 up keep their order, and negative ones have the highest bit set. So two operations a value
/// suffice, which compilers turn into vectors.
bool are_surely_good(std::span<const glm::vec3> texels) {
    constexpr std::uint32_t Negative = 1u << 31u;
    if (texels.empty())
        return true;
    const float* values = &texels.front().x;
    std::uint32_t bad = 0;
    for (std::size_t i = 0; i < 3 * texels.size(); ++i) {
        const auto bits = glm::floatBitsToUint(values[i]);
        bad |= bits | (glm::floatBitsToUint(MaxRadiance) - bits);
    }
    return (bad & Negative) == 0;
}

} // namespace

void require_radiance(std::span<const glm::vec3> texels) {
    constexpr std::size_t Grain = 1 << 16;
    if (texels.size() <= Grain && are_surely_good(texels))
        return; // rows of an edit: not worth a task
    std::atomic<bool> good = true;
    files::parallel_for(files::IndexRange<std::size_t>(0, texels.size(), Grain),
                        [&](const auto& part) {
                            if (!are_surely_good(texels.subspan(part.begin(), part.size())))
                                good = false;
                        });
    if (good)
        return;
    const auto bad = std::find_if_not(texels.begin(), texels.end(), is_good);
    if (bad != texels.end())
        throw std::invalid_argument(
            fmt::format("expected finite radiance from 0 to {}, got ({}, {}, {})", MaxRadiance,
                        bad->r, bad->g, bad->b));
}

BinnedEnvironment EnvironmentBinner::bin(std::shared_ptr<const cubemap::CubeMap> map) {
    using Clock = std::chrono::steady_clock;
    const auto seconds_since = [](Clock::time_point start) {
        return std::chrono::duration<double>(Clock::now() - start).count();
    };
    if (!map)
        throw std::invalid_argument("expected an environment");
    const std::size_t r = map->resolution;
    if (r == 0 || map->texels.size() != cubemap::NumFaces * r * r)
        throw std::invalid_argument(
            fmt::format("expected 6 x {0} x {0} texels, got {1}", r, map->texels.size()));
    require_radiance(map->texels);

    BinnedEnvironment result;
    auto start = Clock::now();
    if (!binning_ || binning_->resolution() != map->resolution)
        binning_ = std::make_shared<const LightBinning>(map->resolution);
    result.binning = binning_;
    result.map = std::move(map);
    result.sums = binning_->sums(*result.map, transfer_.quadtree.leaves());
    result.powers.resize(result.sums.size());
    std::transform(result.sums.begin(), result.sums.end(), result.powers.begin(),
                   std::mem_fn(&VectorIrradiance::power));
    result.seconds_bin = seconds_since(start);

    start = Clock::now();
    if (sharp_tolerance_ > 0.0f)
        result.sharp_lights =
            find_sharp_lights(*result.map, *binning_, transfer_, result.powers, sharp_tolerance_);
    result.seconds_sharp = seconds_since(start);
    return result;
}

} // namespace relumine::relight
