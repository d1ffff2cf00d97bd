#include "data_gen/environments.h"

#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <stdexcept>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace relumine::data_gen {
namespace {

double radians(double degrees) {
    return degrees * std::numbers::pi / 180.0;
}

TEST(ConstantTest, HasClosedForms) {
    const cubemap::CubeMap map = constant(33, {1.0f, 2.0f, 0.5f});
    const glm::dvec3 power = cubemap::total_power(map);
    EXPECT_NEAR(power.x, 4.0 * std::numbers::pi, 1e-5);
    EXPECT_NEAR(power.y, 8.0 * std::numbers::pi, 1e-5);
    EXPECT_NEAR(cubemap::irradiance(constant(64), {0.0, 1.0, 0.0}).x, std::numbers::pi, 1e-3);
    EXPECT_THROW((void)constant(0), std::invalid_argument);
}

// Along faces' middles, edges and corners, just beside them, and anywhere.
const std::vector<glm::dvec3> Directions = {{0, 0, 1},        {-1, 0, 0},         {0, -1, 0},
                                            {1, 1, 0},        {0, -1, 1},         {1, 1, 1},
                                            {-1, 1, -1},      {1, 0.9999, 0},     {1, 1, 0.998},
                                            {0.3, 0.8, -0.4}, {-0.77, 0.1, 0.61}, {0.01, -1, 0.02}};

TEST(DiscLightTest, EnergyDependsNeitherOnPlaceNorResolution) {
    for (const double degrees : {0.001, 0.05, 0.2665, 1.0, 7.0, 30.0, 60.0, 90.0}) {
        const double expected = 3.0 * 2.0 * std::numbers::pi * (1.0 - std::cos(radians(degrees)));
        for (const std::uint32_t resolution : {1u, 7u, 32u, 100u, 256u}) {
            for (const glm::dvec3& direction : Directions) {
                const cubemap::CubeMap map =
                    disc_light(resolution, direction, degrees, glm::vec3(0.0f, 3.0f, 0.0f));
                EXPECT_NEAR(cubemap::total_power(map).y / expected, 1.0, 5e-4)
                    << degrees << " degrees, R = " << resolution << ", direction " << direction.x
                    << " " << direction.y;
            }
        }
    }
}

TEST(DiscLightTest, IrradianceHasAClosedForm) {
    for (const double degrees : {0.2665, 2.0, 20.0, 90.0}) {
        const double expected =
            std::numbers::pi * std::sin(radians(degrees)) * std::sin(radians(degrees));
        for (const glm::dvec3& direction : Directions) {
            const cubemap::CubeMap map = disc_light(128, direction, degrees);
            EXPECT_NEAR(cubemap::irradiance(map, glm::normalize(direction)).x / expected, 1.0, 1e-3)
                << degrees;
        }
    }
}

TEST(DiscLightTest, LightComesFromItsDirection) {
    for (const glm::dvec3& direction : Directions) {
        const cubemap::CubeMap map = disc_light(256, direction, 1.0);
        const glm::dvec3 along = {
            cubemap::irradiance(map, {1, 0, 0}).x - cubemap::irradiance(map, {-1, 0, 0}).x,
            cubemap::irradiance(map, {0, 1, 0}).x - cubemap::irradiance(map, {0, -1, 0}).x,
            cubemap::irradiance(map, {0, 0, 1}).x - cubemap::irradiance(map, {0, 0, -1}).x};
        // A tenth of a texel.
        EXPECT_LT(glm::distance(glm::normalize(along), glm::normalize(direction)),
                  0.1 * 2.0 / 256.0);
    }
}

TEST(DiscLightTest, TexelsInsideAreFullAndOutsideDark) {
    const glm::dvec3 direction = glm::normalize(glm::dvec3(0.2, 0.5, 0.9));
    const std::uint32_t resolution = 64;
    const cubemap::CubeMap map = disc_light(resolution, direction, 10.0, glm::vec3(2.0f));
    const double margin = radians(1.7); // a texel's diagonal
    for (const cubemap::Face face : cubemap::AllFaces) {
        for (std::uint32_t y = 0; y < resolution; ++y) {
            for (std::uint32_t x = 0; x < resolution; ++x) {
                const float value = map.at(face, x, y).x;
                const double angle = std::acos(
                    glm::dot(cubemap::texel_direction(face, x, y, resolution), direction));
                if (angle < radians(10.0) - margin) {
                    ASSERT_EQ(value, 2.0f);
                } else if (angle > radians(10.0) + margin) {
                    ASSERT_EQ(value, 0.0f);
                } else {
                    ASSERT_TRUE(value >= 0.0f && value <= 2.0f);
                }
            }
        }
    }
}

TEST(DiscLightTest, RefusesBadArguments) {
    EXPECT_THROW((void)disc_light(8, {0, 0, 0}, 1.0), std::invalid_argument);
    EXPECT_THROW((void)disc_light(8, {0, std::nan(""), 1}, 1.0), std::invalid_argument);
    EXPECT_THROW((void)disc_light(8, {0, 1, 0}, 0.0), std::invalid_argument);
    EXPECT_THROW((void)disc_light(8, {0, 1, 0}, 90.1), std::invalid_argument);
    EXPECT_THROW((void)disc_light(0, {0, 1, 0}, 1.0), std::invalid_argument);
}

TEST(SoftBoxTest, PowerIsThatOfARectangle) {
    // Half of the soft edge counts: the fall is symmetric.
    const SoftBox box{.direction = {0.3, 0.2, 1.0},
                      .half_width = 0.5,
                      .half_height = 0.3,
                      .edge = 0.04,
                      .radiance = glm::vec3(5.0f)};
    const double a = 0.48;
    const double b = 0.28;
    const double solid_angle = 4.0 * std::atan(a * b / std::sqrt(1.0 + a * a + b * b));
    for (const std::uint32_t resolution : {16u, 64u, 200u}) {
        const cubemap::CubeMap map = soft_boxes(resolution, std::array{box}, glm::vec3(0.5f));
        EXPECT_NEAR((cubemap::total_power(map).x - 0.5 * 4.0 * std::numbers::pi) /
                        (5.0 * solid_angle),
                    1.0, 2e-3)
            << resolution;
    }
}

TEST(SoftBoxTest, IsFullInTheMiddleAndAddsToTheBackground) {
    const SoftBox box{.direction = {0.0, 0.0, -2.0}, .radiance = {1.0f, 2.0f, 3.0f}};
    const cubemap::CubeMap map = soft_boxes(64, std::array{box, box}, glm::vec3(0.25f));
    EXPECT_EQ(map.at(cubemap::Face::NegativeZ, 32, 32), glm::vec3(2.25f, 4.25f, 6.25f));
    EXPECT_EQ(map.at(cubemap::Face::PositiveZ, 32, 32), glm::vec3(0.25f)) << "nothing behind";
}

TEST(SoftBoxTest, RefusesBadArguments) {
    const auto make = [](const SoftBox& box) {
        return soft_boxes(4, std::array{box}, glm::vec3(0.0f));
    };
    EXPECT_THROW((void)make({.direction = {0, 0, 0}}), std::invalid_argument);
    EXPECT_THROW((void)make({.edge = 0.0}), std::invalid_argument);
    EXPECT_THROW((void)make({.half_width = 0.1, .edge = 0.2}), std::invalid_argument);
}

class SunAndSkyTest : public testing::TestWithParam<std::uint32_t> {};
INSTANTIATE_TEST_SUITE_P(Resolutions, SunAndSkyTest, testing::Values(16u, 63u, 128u, 512u));

TEST_P(SunAndSkyTest, KeepsTheSunsEnergyAndPlace) {
    const std::uint32_t resolution = GetParam();
    for (const double azimuth : {-60.0, 45.0}) {
        const DaylightOptions options{.sun_azimuth_degrees = azimuth};
        const Daylight daylight(options);
        const cubemap::CubeMap map = sun_and_sky(resolution, options);
        const std::vector<double> solid_angles = cubemap::texel_solid_angles(resolution);
        const double texel = 2.0 / resolution;
        glm::dvec3 sun_power(0.0);
        glm::dvec3 brightest_direction(0.0);
        float brightest = 0.0f;
        for (const cubemap::Face face : cubemap::AllFaces) {
            for (std::uint32_t y = 0; y < resolution; ++y) {
                for (std::uint32_t x = 0; x < resolution; ++x) {
                    const glm::dvec3 w = cubemap::texel_direction(face, x, y, resolution);
                    const glm::dvec3 radiance(map.at(face, x, y));
                    if (glm::distance(w, daylight.sun_direction()) <
                        radians(Daylight::SunRadiusDegrees) + texel) {
                        sun_power += (radiance - daylight.sky(w)) *
                                     solid_angles[std::size_t{y} * resolution + x];
                    }
                    if (map.at(face, x, y).y > brightest) {
                        brightest = map.at(face, x, y).y;
                        brightest_direction = w;
                    }
                }
            }
        }
        const double sun_solid_angle =
            2.0 * std::numbers::pi * (1.0 - std::cos(radians(Daylight::SunRadiusDegrees)));
        for (int channel = 0; channel < 3; ++channel) {
            EXPECT_NEAR(sun_power[channel] / (daylight.sun()[channel] * sun_solid_angle), 1.0,
                        5e-3);
        }
        EXPECT_LT(glm::distance(brightest_direction, daylight.sun_direction()), texel);
    }
}

TEST_P(SunAndSkyTest, GroundLiesBelowTheHorizon) {
    const std::uint32_t resolution = GetParam();
    const Daylight daylight;
    const cubemap::CubeMap map = sun_and_sky(resolution);
    const glm::vec3 ground(daylight.ground());
    EXPECT_LT(
        glm::distance(map.at(cubemap::Face::NegativeY, resolution / 3, resolution / 2), ground),
        1e-5f);
    const auto& above = map.at(cubemap::Face::NegativeZ, resolution / 2, resolution / 2 - 1);
    const auto& below = map.at(cubemap::Face::NegativeZ, resolution / 2, resolution / 2 + 1);
    EXPECT_GT(above.y, ground.y);
    EXPECT_LT(glm::distance(below, ground), 1e-5f);
    if (resolution % 2 == 1) {
        // The horizon cuts through the middle row.
        const auto& on = map.at(cubemap::Face::NegativeZ, resolution / 2, resolution / 2);
        EXPECT_LT(ground.y, on.y);
        EXPECT_LT(on.y, above.y);
    }
}

TEST(SunAndSkyPowerTest, TotalDoesNotDependOnResolution) {
    const glm::dvec3 coarse = cubemap::total_power(sun_and_sky(15));
    const glm::dvec3 fine = cubemap::total_power(sun_and_sky(600));
    for (int channel = 0; channel < 3; ++channel) {
        EXPECT_NEAR(coarse[channel] / fine[channel], 1.0, 1e-3);
    }
}

TEST(EnvironmentsTest, AllAreFiniteLightAndNotNegative) {
    std::set<std::string_view> names;
    for (const Environment& environment : environments()) {
        EXPECT_TRUE(names.insert(environment.name).second);
        EXPECT_FALSE(environment.description.empty());
        for (const std::uint32_t resolution : {1u, 5u, 64u}) {
            const cubemap::CubeMap map = environment.make(resolution);
            ASSERT_EQ(map.texels.size(), std::size_t{6} * resolution * resolution);
            for (const glm::vec3& texel : map.texels) {
                for (int channel = 0; channel < 3; ++channel) {
                    ASSERT_TRUE(std::isfinite(texel[channel]) && texel[channel] >= 0.0f)
                        << environment.name;
                }
            }
        }
        // A white floor shows well: outgoing radiance about 1.
        const double floor =
            cubemap::irradiance(environment.make(128), {0.0, 1.0, 0.0}).y / std::numbers::pi;
        EXPECT_GT(floor, 0.7) << environment.name;
        EXPECT_LT(floor, 1.3) << environment.name;
        EXPECT_EQ(environment.make(16).texels, environment.make(16).texels) << environment.name;
    }
}

} // namespace
} // namespace relumine::data_gen
