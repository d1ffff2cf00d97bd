#include "relight/harmonics/harmonics.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "cubemap/cube_map.h"

namespace relumine::relight {
namespace {

constexpr double Pi = std::numbers::pi;

TEST(Harmonics, HaveThePublishedConstants) {
    // Ramamoorthi and Hanrahan 2001, Eq. 3.
    const glm::dvec3 d = glm::normalize(glm::dvec3(0.3, -0.5, 0.8));
    const auto values = harmonics(d);
    const std::array<double, MaxHarmonics> expected = {0.282095,
                                                       0.488603 * d.y,
                                                       0.488603 * d.z,
                                                       0.488603 * d.x,
                                                       1.092548 * d.x * d.y,
                                                       1.092548 * d.y * d.z,
                                                       0.315392 * (3.0 * d.z * d.z - 1.0),
                                                       1.092548 * d.x * d.z,
                                                       0.546274 * (d.x * d.x - d.y * d.y)};
    for (std::size_t k = 0; k < MaxHarmonics; ++k)
        EXPECT_NEAR(values[k], expected[k], 1e-6) << HarmonicNames[k];
}

TEST(Harmonics, AreOrthonormal) {
    constexpr std::uint32_t R = 64;
    const std::vector<double> solid_angles = cubemap::texel_solid_angles(R);
    std::array<std::array<double, MaxHarmonics>, MaxHarmonics> products{};
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < R; ++y)
            for (std::uint32_t x = 0; x < R; ++x) {
                const auto values = harmonics(cubemap::texel_direction(face, x, y, R));
                for (std::size_t i = 0; i < MaxHarmonics; ++i)
                    for (std::size_t j = 0; j < MaxHarmonics; ++j)
                        products[i][j] += values[i] * values[j] * solid_angles[y * R + x];
            }
    for (std::size_t i = 0; i < MaxHarmonics; ++i)
        for (std::size_t j = 0; j < MaxHarmonics; ++j)
            EXPECT_NEAR(products[i][j], i == j ? 1.0 : 0.0, 2e-4) << i << " " << j;
}

TEST(Harmonics, IrradianceOfAConstantSkyIsPi) {
    std::array<glm::vec3, MaxHarmonics> light{};
    light[0] = glm::vec3(static_cast<float>(2.0 * std::sqrt(Pi)));
    for (const glm::vec3& normal : {glm::vec3(0, 1, 0), glm::vec3(0.6f, 0, -0.8f)})
        for (const std::uint32_t order : {1u, 2u, 3u})
            EXPECT_NEAR(irradiance(std::span(light).first(num_harmonics(order)), normal).g, Pi,
                        1e-6);
    EXPECT_NEAR(mean_radiance(light[0]).r, 1.0f, 1e-6f);
}

TEST(Harmonics, IrradianceHasThePublishedMatrix) {
    // Ramamoorthi and Hanrahan 2001, Eqs. 12 and 13: c1 to c5, as renderers have them.
    const std::array<double, MaxHarmonics> c = {0.886227,     2 * 0.511664, 2 * 0.511664,
                                                2 * 0.511664, 2 * 0.429043, 2 * 0.429043,
                                                0.743125,     2 * 0.429043, 0.429043};
    const glm::dvec3 n = glm::normalize(glm::dvec3(-0.2, 0.7, 0.4));
    const std::array<double, MaxHarmonics> polynomials = {1.0,
                                                          n.y,
                                                          n.z,
                                                          n.x,
                                                          n.x * n.y,
                                                          n.y * n.z,
                                                          n.z * n.z - 0.247708 / 0.743125,
                                                          n.x * n.z,
                                                          n.x * n.x - n.y * n.y};
    for (std::size_t k = 0; k < MaxHarmonics; ++k) {
        std::array<glm::vec3, MaxHarmonics> light{};
        light[k] = glm::vec3(1.0f);
        EXPECT_NEAR(irradiance(light, n).r, c[k] * polynomials[k], 2e-6) << HarmonicNames[k];
    }
}

TEST(Harmonics, OneDistantLightGivesThePartOfACosineThatTheOrderHolds) {
    // A unit light from d: E(n) = 1/4 + 1/2 c + 5/32 (3 c^2 - 1), c = n.d. The true cosine is near.
    const glm::dvec3 d = glm::normalize(glm::dvec3(1, 2, -1));
    const auto values = harmonics(d);
    std::array<glm::vec3, MaxHarmonics> light{};
    for (std::size_t k = 0; k < MaxHarmonics; ++k)
        light[k] = glm::vec3(static_cast<float>(values[k]));
    for (int i = 0; i < 64; ++i) {
        const double angle = 0.1 * i;
        const glm::vec3 n(std::cos(angle), std::sin(angle), 0.0);
        const double c = glm::dot(glm::dvec3(n), d);
        const double e = irradiance(light, n).b;
        EXPECT_NEAR(e, 0.25 + 0.5 * c + 5.0 / 32.0 * (3.0 * c * c - 1.0), 1e-6);
        EXPECT_NEAR(e, std::max(0.0, c), 0.1);
    }
}

TEST(Harmonics, BoundLightHasTheKnownIrradianceAndChangesLittle) {
    std::array<glm::vec3, MaxHarmonics> light{};
    for (std::size_t k = 0; k < MaxHarmonics; ++k)
        light[k] = {1.0f / static_cast<float>(k + 1), 0.1f * static_cast<float>(k), 2.0f};
    const glm::vec3 normal = glm::normalize(glm::vec3(0.2f, -0.9f, 0.3f));
    const glm::dvec3 known(1.5, 0.25, 4.0);
    for (const std::uint32_t order : {2u, 3u}) {
        std::vector<glm::vec3> bound(light.begin(),
                                     light.begin() + static_cast<long>(num_harmonics(order)));
        bind_irradiance(bound, normal, known);
        const glm::dvec3 e = irradiance(bound, normal);
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(e[channel], known[channel], 1e-6 * known[channel]);
        const std::vector<glm::vec3> before = bound;
        bind_irradiance(bound, normal, known);
        for (std::size_t k = 0; k < bound.size(); ++k)
            EXPECT_NEAR(glm::distance(bound[k], before[k]), 0.0f, 1e-6f);
    }
    std::vector<glm::vec3> same(light.begin(), light.end());
    bind_irradiance(same, glm::vec3(0.0f), known);
    EXPECT_TRUE(std::equal(same.begin(), same.end(), light.begin()));
}

TEST(Harmonics, OrdersAre2And3) {
    EXPECT_NO_THROW(require_order(2));
    EXPECT_NO_THROW(require_order(3));
    EXPECT_THROW(require_order(1), std::invalid_argument);
    EXPECT_THROW(require_order(7), std::invalid_argument);
}

} // namespace
} // namespace relumine::relight
