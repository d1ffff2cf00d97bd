#include "lights/importance_sampling.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/lights/test_maps.h"

namespace relumine::lights {
namespace {

TEST(ImportanceSampling, LightsHaveEqualLuminance) {
    const auto image = wild(64, 32);
    const LatLongGrid grid(image);
    for (const std::size_t n : {1u, 2u, 5u, 64u, 300u}) {
        const auto lights = importance_sample(grid, n, 3);
        const double share = luminance(power(image)) / static_cast<double>(n);
        for (const DistantLight& light : lights)
            EXPECT_NEAR(luminance(light.irradiance), share, 1e-9 * share);
    }
}

double overlap(double a0, double a1, double b0, double b1) {
    return std::max(std::min(a1, b1) - std::max(a0, b0), 0.0);
}

TEST(ImportanceSampling, EachPixelGoesToTheStrataItLiesIn) {
    // Every pixel against every stratum: 5 lights are 2 rows of strata, of 2 and 3.
    const auto image = wild(16, 8);
    const LatLongGrid grid(image);
    const auto lights = importance_sample(grid, 5, 1);
    struct Stratum {
        double top, bottom, left, right;
    };
    const std::vector<Stratum> strata = {{0.0, 0.4, 0.0, 0.5},
                                         {0.0, 0.4, 0.5, 1.0},
                                         {0.4, 1.0, 0.0, 1.0 / 3.0},
                                         {0.4, 1.0, 1.0 / 3.0, 2.0 / 3.0},
                                         {0.4, 1.0, 2.0 / 3.0, 1.0}};
    std::vector<double> rows(8, 0.0);
    double all = 0.0;
    for (std::uint32_t y = 0; y < 8; ++y)
        for (std::uint32_t x = 0; x < 16; ++x) {
            rows[y] += grid.energy(x, y);
            all += grid.energy(x, y);
        }
    for (std::size_t s = 0; s < strata.size(); ++s) {
        glm::dvec3 expected(0.0);
        double above = 0.0;
        for (std::uint32_t y = 0; y < 8; ++y) {
            const double down =
                overlap(above / all, (above + rows[y]) / all, strata[s].top, strata[s].bottom) *
                all / rows[y];
            double left = 0.0;
            for (std::uint32_t x = 0; x < 16; ++x) {
                const double energy = grid.energy(x, y);
                if (energy > 0.0) {
                    const double across = overlap(left / rows[y], (left + energy) / rows[y],
                                                  strata[s].left, strata[s].right) *
                                          rows[y] / energy;
                    expected += down * across * grid.solid_angle(x, y) * grid.radiance(x, y);
                }
                left += energy;
            }
            above += rows[y];
        }
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(lights[s].irradiance[channel], expected[channel], 1e-9 * all) << s;
    }
}

TEST(ImportanceSampling, LightsStandWhereThereIsLight) {
    auto image = constant(64, 32, glm::vec3(0.0f));
    image.pixels[10 * 64 + 20] = glm::vec3(5.0f);
    image.pixels[25 * 64 + 50] = glm::vec3(1.0f);
    const LatLongGrid grid(image);
    for (std::uint64_t seed = 0; seed < 50; ++seed)
        for (const DistantLight& light : importance_sample(grid, 9, seed)) {
            const double to_first = glm::distance(light.direction, grid.centre({20, 10, 21, 11}));
            const double to_second = glm::distance(light.direction, grid.centre({50, 25, 51, 26}));
            EXPECT_LT(std::min(to_first, to_second), 0.08); // half a pixel's diagonal
        }
}

TEST(ImportanceSampling, OtherSeedsOtherDirectionsWithTheRightMean) {
    // A white map, so that strata and energy are independent of colour: the mean over seeds tends
    // to the exact irradiance.
    const auto image = lat_long(64, 32, [](std::uint32_t x, std::uint32_t y) {
        return glm::vec3(0.1f + static_cast<float>(x % 16) * static_cast<float>(y));
    });
    const LatLongGrid grid(image);
    const glm::dvec3 normal = glm::normalize(glm::dvec3(1.0, 2.0, -0.5));
    double exact = 0.0;
    cubemap::for_each_pixel(
        cubemap::shape_of(image), [&](std::size_t pixel, const cubemap::PixelPlace& place) {
            exact += static_cast<double>(image.pixels[pixel].g) * place.solid_angle *
                     std::max(glm::dot(place.direction, normal), 0.0);
        });
    double mean = 0.0;
    constexpr int NumSeeds = 2000;
    for (std::uint64_t seed = 1; seed <= NumSeeds; ++seed)
        for (const DistantLight& light : importance_sample(grid, 8, seed))
            mean +=
                light.irradiance.g * std::max(glm::dot(light.direction, normal), 0.0) / NumSeeds;
    EXPECT_NEAR(mean, exact, 0.01 * exact);
    EXPECT_NE(importance_sample(grid, 8, 1)[3].direction,
              importance_sample(grid, 8, 2)[3].direction);
    EXPECT_EQ(importance_sample(grid, 8, 1)[3].direction,
              importance_sample(grid, 8, 1)[3].direction);
}

} // namespace
} // namespace relumine::lights
