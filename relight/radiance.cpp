#include "relight/radiance.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "files/parallel.h"

namespace relumine::relight {

namespace {

bool is_radiance(const glm::vec3& texel) {
    // NaN fails both comparisons.
    const auto good = [](float value) {
        return value >= 0.0f && value <= MaxRadiance;
    };
    return good(texel.r) && good(texel.g) && good(texel.b);
}

// As whole numbers, floats from 0 up keep their order, and negative ones have the highest bit set.
// So two operations a value suffice, which compilers turn into vectors. False for -0, too.
bool is_surely_radiance(std::span<const glm::vec3> texels) {
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
    if (texels.size() <= Grain && is_surely_radiance(texels))
        return; // rows of an edit: not worth a task
    std::atomic<bool> good = true;
    files::parallel_for(files::IndexRange<std::size_t>(0, texels.size(), Grain),
                        [&](const auto& part) {
                            if (!is_surely_radiance(texels.subspan(part.begin(), part.size())))
                                good = false;
                        });
    if (good)
        return;
    const auto bad = std::find_if_not(texels.begin(), texels.end(), is_radiance);
    if (bad != texels.end())
        throw std::invalid_argument(
            fmt::format("expected finite radiance from 0 to {}, got ({}, {}, {})", MaxRadiance,
                        bad->r, bad->g, bad->b));
}

} // namespace relumine::relight
