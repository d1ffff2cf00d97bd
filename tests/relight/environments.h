// Environments of the relighting tests, and how results are compared.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <span>

#include <glm/vec3.hpp>
#include <gtest/gtest.h>

#include "cubemap/cube_map.h"

namespace relumine::scenes {

/// Texels between 0 and 1, a few of them `peak`.
[[nodiscard]] inline cubemap::CubeMap random_environment(std::uint32_t resolution,
                                                         std::uint32_t seed, float peak = 50.0f) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> radiance(0.0f, 1.0f);
    cubemap::CubeMap environment(resolution);
    for (glm::vec3& texel : environment.texels) {
        texel = {radiance(random), radiance(random), radiance(random)};
        if (random() % 100 == 0)
            texel *= peak;
    }
    return environment;
}

/// Each texel times `factor(direction)`.
template<typename Factor>
[[nodiscard]] cubemap::CubeMap times(cubemap::CubeMap environment, const Factor& factor) {
    const std::uint32_t resolution = environment.resolution;
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < resolution; ++y)
            for (std::uint32_t x = 0; x < resolution; ++x)
                environment.at(face, x, y) *=
                    factor(cubemap::texel_direction(face, x, y, resolution));
    return environment;
}

/// A sky of radiance `radiance(direction)`.
template<typename Radiance>
[[nodiscard]] cubemap::CubeMap sky_of(std::uint32_t resolution, const Radiance& radiance) {
    return times(cubemap::CubeMap(resolution, glm::vec3(1.0f)), radiance);
}

/// A smooth sky: polynomials of the direction, between 0.1 and 3.
[[nodiscard]] inline cubemap::CubeMap smooth_environment(std::uint32_t resolution) {
    return sky_of(resolution, [](const glm::dvec3& w) {
        return glm::vec3(glm::dvec3(1.0 + 0.5 * w.x + 0.4 * w.y * w.z, 1.5 + w.y, 0.2 + w.z * w.z));
    });
}

/// Every value within `relative` of itself, and (for what is nearly black) of a tenth of the mean.
inline void expect_close(std::span<const glm::vec3> actual, std::span<const glm::vec3> expected,
                         double relative) {
    ASSERT_EQ(actual.size(), expected.size());
    double mean = 0.0;
    for (const glm::vec3& b : expected)
        mean += static_cast<double>(b.r + b.g + b.b) / 3.0;
    mean /= static_cast<double>(expected.size());
    double worst = 0.0;
    for (std::size_t i = 0; i < expected.size(); ++i)
        for (int channel = 0; channel < 3; ++channel) {
            const auto a = static_cast<double>(actual[i][channel]),
                       e = static_cast<double>(expected[i][channel]);
            const double error = std::abs(a - e) / std::max({std::abs(e), 0.1 * mean, 1e-30});
            worst = std::max(worst, std::isfinite(error) ? error : 1e30);
        }
    EXPECT_LE(worst, relative);
}

} // namespace relumine::scenes
