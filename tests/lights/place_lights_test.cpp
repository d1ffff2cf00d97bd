// What every method promises.
#include "lights/place_lights.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "cubemap/cube_map.h"
#include "files/parallel.h"
#include "tests/lights/test_maps.h"

namespace relumine::lights {
namespace {

using testing::HasSubstr;

constexpr double FullSphere = 4.0 * std::numbers::pi;

class EveryMethod : public testing::TestWithParam<Method> {};

INSTANTIATE_TEST_SUITE_P(PlaceLights, EveryMethod, testing::ValuesIn(AllMethods),
                         [](const auto& method) {
                             std::string result(name(method.param));
                             std::erase(result, '-');
                             return result;
                         });

void expect_same_power(const std::vector<DistantLight>& lights,
                       const cubemap::EnvironmentImage& image) {
    const glm::dvec3 expected = power(image);
    const glm::dvec3 got = total_irradiance(lights);
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(got[channel], expected[channel], 1e-9 * expected[channel] + 1e-300);
}

TEST_P(EveryMethod, KeepsThePowerForAnyNumberOfLights) {
    for (const auto& image :
         {wild(64, 32), wild(37, 20, 7), wild(5, 90, 3), wild(1, 64), wild(64, 1)}) {
        for (const std::size_t n : {1u, 2u, 3u, 7u, 16u, 61u, 64u}) {
            SCOPED_TRACE(testing::Message() << image.width << "x" << image.height << " " << n);
            const Placement placement = place(GetParam(), image, n);
            ASSERT_EQ(placement.lights.size(), n);
            expect_same_power(placement.lights, image);
            double solid_angle = 0.0;
            for (const DistantLight& light : placement.lights) {
                EXPECT_NEAR(glm::length(light.direction), 1.0, 1e-12);
                EXPECT_GT(light.solid_angle, 0.0);
                solid_angle += light.solid_angle;
            }
            EXPECT_LE(solid_angle, FullSphere * (1.0 + 1e-12));
            if (!placement.regions.empty()) {
                EXPECT_NEAR(solid_angle, FullSphere, 1e-9);
            }
        }
    }
}

TEST_P(EveryMethod, SamplesOnTheBordersHaveTheirOwnSolidAngles) {
    cubemap::EnvironmentImage image = wild(33, 17);
    image.sampling = cubemap::Sampling::Borders;
    expect_same_power(place(GetParam(), image, 16).lights, image);
}

TEST_P(EveryMethod, EveryPixelItsOwnLight) {
    const auto image = wild(8, 4);
    const Placement placement = place(GetParam(), image, 32);
    ASSERT_EQ(placement.lights.size(), 32u);
    expect_same_power(placement.lights, image);
    for (const PixelRectangle& region : placement.regions) {
        EXPECT_EQ(region.width() * region.height(), 1u);
    }
}

TEST_P(EveryMethod, BlackMapsGetBlackLights) {
    for (const auto& image : {constant(1, 1, glm::vec3(0.0f)), constant(32, 16, glm::vec3(0.0f))}) {
        for (const std::size_t n :
             {std::size_t{1}, image.pixels.size() / 2 + 1, image.pixels.size()}) {
            const Placement placement = place(GetParam(), image, n);
            ASSERT_EQ(placement.lights.size(), n);
            for (const DistantLight& light : placement.lights) {
                EXPECT_EQ(light.irradiance, glm::dvec3(0.0));
                EXPECT_NEAR(glm::length(light.direction), 1.0, 1e-12);
            }
        }
    }
}

TEST_P(EveryMethod, OnePixelIsOneLight) {
    const Placement placement = place(GetParam(), constant(1, 1, {1.0f, 2.0f, 3.0f}), 1);
    ASSERT_EQ(placement.lights.size(), 1u);
    EXPECT_NEAR(placement.lights[0].irradiance.r, FullSphere, 1e-12);
    EXPECT_NEAR(placement.lights[0].irradiance.b, 3.0 * FullSphere, 1e-12);
    EXPECT_NEAR(placement.lights[0].solid_angle, FullSphere, 1e-12);
}

TEST_P(EveryMethod, ConstantMapsGiveEvenLights) {
    // An unshadowed surface gets pi times the radiance, whatever its normal.
    const auto lights = place(GetParam(), constant(256, 128, glm::vec3(1.0f)), 256).lights;
    for (const glm::dvec3 normal : {glm::dvec3(0, 1, 0), glm::dvec3(0, -1, 0), glm::dvec3(1, 0, 0),
                                    glm::dvec3(0, 0, 1), glm::normalize(glm::dvec3(1, 2, -2))}) {
        double irradiance = 0.0;
        for (const DistantLight& light : lights)
            irradiance += light.irradiance.g * std::max(glm::dot(light.direction, normal), 0.0);
        EXPECT_NEAR(irradiance, std::numbers::pi, 0.03 * std::numbers::pi);
    }
}

TEST_P(EveryMethod, RepeatsItselfForAnyNumberOfThreads) {
    const auto image = wild(300, 150);
    const Placement many = place(GetParam(), image, 100, 5);
    files::ThreadLimit one(1);
    const Placement single = place(GetParam(), image, 100, 5);
    EXPECT_EQ(many.regions, single.regions);
    ASSERT_EQ(many.lights.size(), single.lights.size());
    for (std::size_t i = 0; i < many.lights.size(); ++i) {
        EXPECT_EQ(many.lights[i].direction, single.lights[i].direction);
        EXPECT_EQ(many.lights[i].irradiance, single.lights[i].irradiance);
        EXPECT_EQ(many.lights[i].solid_angle, single.lights[i].solid_angle);
    }
}

TEST_P(EveryMethod, TakesCubeMaps) {
    cubemap::CubeMap studio(8, glm::vec3(0.25f));
    studio.at(cubemap::Face::PositiveX, 3, 4) = {100.0f, 50.0f, 20.0f};
    cubemap::CubeMap lamp(32);
    lamp.at(cubemap::Face::PositiveX, 15, 16) = {512.0f, 512.0f, 0.0f};
    for (const cubemap::CubeMap& map : {studio, lamp}) {
        const glm::dvec3 expected = cubemap::total_power(map);
        const glm::dvec3 got = total_irradiance(place_lights(GetParam(), map, 12));
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(got[channel], expected[channel], 2e-7 * expected[channel]);
    }
    lamp.texels[7].g = -1.0f;
    EXPECT_THROW((void)place_lights(GetParam(), lamp, 12), std::invalid_argument);
}

TEST_P(EveryMethod, RefusesWhatCannotBe) {
    const auto message = [&](const cubemap::EnvironmentImage& image, std::size_t n) {
        try {
            (void)place(GetParam(), image, n);
        } catch (const std::invalid_argument& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    const auto image = constant(4, 2, glm::vec3(1.0f));
    EXPECT_EQ(message(image, 0), "expected 1 to 8 lights for 4 x 2 pixels, got 0");
    EXPECT_EQ(message(image, 9), "expected 1 to 8 lights for 4 x 2 pixels, got 9");
    for (const float bad : {-1.0f, std::nanf(""), INFINITY}) {
        auto broken = image;
        broken.pixels[6].g = bad;
        EXPECT_THAT(message(broken, 2), HasSubstr("in pixel (2, 1)"));
    }
    auto short_of_pixels = image;
    short_of_pixels.pixels.pop_back();
    EXPECT_THAT(message(short_of_pixels, 2), HasSubstr("got 7"));
    EXPECT_THAT(message({}, 1), HasSubstr("expected 0 x 0 pixels and at least one, got 0"));
    auto cube = constant(4, 24, glm::vec3(1.0f));
    cube.layout = cubemap::Layout::Cube;
    EXPECT_THAT(message(cube, 1), HasSubstr("expected a lat-long image, got a"));
}

TEST(PlaceLights, MethodsHaveNames) {
    for (const Method method : AllMethods)
        EXPECT_EQ(method_named(name(method)), method);
    EXPECT_EQ(method_named("median"), std::nullopt);
}

} // namespace
} // namespace relumine::lights
