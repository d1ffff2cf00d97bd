#include "lights/sun_split.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "cubemap/image/image_layout.h"
#include "cubemap/resample/resample.h"
#include "data_gen/environments.h"
#include "files/parallel.h"
#include "tests/lights/disc_light.h"
#include "tests/real_data.h"

namespace relumine::lights {
namespace {

/// 32 directions spread evenly over the sphere.
std::vector<glm::dvec3> normals() {
    std::vector<glm::dvec3> result;
    for (int i = 0; i < 32; ++i) {
        const double y = 1.0 - (2.0 * i + 1.0) / 32.0, across = std::sqrt(1.0 - y * y),
                     turn = i * 2.399963;
        result.emplace_back(across * std::cos(turn), y, across * std::sin(turn));
    }
    return result;
}

glm::dvec3 irradiance_of(const cubemap::CubeMap& map, const glm::dvec3& normal) {
    return cubemap::irradiance(map, normal);
}

glm::dvec3 irradiance_of(const cubemap::EnvironmentImage& image, const glm::dvec3& normal) {
    glm::dvec3 sum(0.0);
    cubemap::for_each_pixel(cubemap::shape_of(image),
                            [&](std::size_t index, const cubemap::PixelPlace& place) {
                                sum += glm::dvec3(image.pixels[index]) * place.solid_angle *
                                       std::max(0.0, glm::dot(normal, place.direction));
                            });
    return sum;
}

/// Largest relative error of irradiance over the normals and the channels.
template<typename Map>
double worst_error(const Map& original, const SunSplit<Map>& split) {
    double worst = 0.0;
    for (const glm::dvec3& normal : normals()) {
        const glm::dvec3 expected = irradiance_of(original, normal);
        const glm::dvec3 result = irradiance_of(split.rest, normal) + irradiance(split.sun, normal);
        for (int channel = 0; channel < 3; ++channel)
            worst = std::max(worst, std::abs(result[channel] / expected[channel] - 1.0));
    }
    return worst;
}

TEST(SunSplit, SumLightsLikeTheOriginal) {
    // The sun low, high and overhead, on faces, edges and near a corner.
    for (const double elevation : {4.0, 35.0, 45.0, 60.0, 90.0}) {
        for (const double azimuth : {-60.0, 0.0, 45.0, 170.0}) {
            const cubemap::CubeMap map = data_gen::sun_and_sky(
                128, {.sun_elevation_degrees = elevation, .sun_azimuth_degrees = azimuth});
            SCOPED_TRACE(testing::Message() << elevation << ' ' << azimuth);
            const auto split = split_sun(map);
            ASSERT_TRUE(split);
            EXPECT_LT(worst_error(map, *split), 1e-3);
            const glm::dvec3 expected = data_gen::direction_from_angles(elevation, azimuth);
            EXPECT_LT(glm::distance(split->sun.direction, expected),
                      5e-3); // 0.3 degrees; a texel has 0.7
            // What is left is a sky without a sun.
            EXPECT_FALSE(split_sun(split->rest));
            const auto brightest = [](const cubemap::CubeMap& m) {
                float value = 0.0f;
                for (const glm::vec3& texel : m.texels)
                    value = std::max(value, texel.y);
                return value;
            };
            EXPECT_LT(brightest(split->rest), std::max(3e-4f * brightest(map), 60.0f));
        }
    }
}

/// The light is round and the sun's pixels are not. That shows where the sun sets on a surface, and
/// only there: by a part of its light that is small against its radius.
TEST(SunSplit, WhereTheSunSetsOnASurface) {
    for (const std::uint32_t resolution : {64u, 256u}) {
        const cubemap::CubeMap map = data_gen::sun_and_sky(resolution);
        const auto split = split_sun(map);
        ASSERT_TRUE(split);
        const glm::dvec3 side =
            glm::normalize(glm::cross(split->sun.direction, glm::dvec3(0.0, 1.0, 0.0)));
        const glm::dvec3 other = glm::cross(split->sun.direction, side);
        const double radius = std::sqrt(split->sun.solid_angle / 3.14159265);
        for (int i = 0; i < 64; ++i) {
            const double turn = 0.7 * i, height = radius * (i % 9 - 4) / 2.0;
            const glm::dvec3 normal = glm::normalize(
                std::cos(turn) * side + std::sin(turn) * other + height * split->sun.direction);
            const double expected = irradiance_of(map, normal).y;
            const double result =
                irradiance_of(split->rest, normal).y + irradiance(split->sun, normal).y;
            EXPECT_NEAR(result, expected, 0.2 * radius * split->sun.irradiance.y)
                << resolution << ' ' << i;
        }
    }
}

TEST(SunSplit, TheGeneratedSunsIrradiance) {
    const data_gen::DaylightOptions options{.sun_elevation_degrees = 40.0,
                                            .sun_azimuth_degrees = 20.0};
    const data_gen::Daylight daylight(options);
    const double sine = std::sin(data_gen::Daylight::SunRadiusDegrees * 3.14159265358979 / 180.0);
    for (const std::uint32_t resolution : {64u, 256u, 1024u}) {
        const auto split = split_sun(data_gen::sun_and_sky(resolution, options));
        ASSERT_TRUE(split);
        for (int channel = 0; channel < 3; ++channel) {
            const double expected = 3.14159265358979 * sine * sine * daylight.sun()[channel];
            EXPECT_NEAR(split->sun.irradiance[channel] / expected, 1.0, 3e-3) << resolution;
        }
        if (resolution == 1024) {
            EXPECT_NEAR(2.0 * std::sqrt(split->sun.solid_angle / 3.14159265358979) * 180.0 /
                            3.14159265358979,
                        0.533, 0.03);
        }
    }
}

TEST(SunSplit, NothingIsNegative) {
    const cubemap::CubeMap map = data_gen::sun_and_sky(128, {.sun_elevation_degrees = 2.0});
    const auto split = split_sun(map);
    ASSERT_TRUE(split);
    for (std::size_t i = 0; i < map.texels.size(); ++i) {
        for (int channel = 0; channel < 3; ++channel) {
            ASSERT_GE(split->rest.texels[i][channel], 0.0f);
            ASSERT_LE(split->rest.texels[i][channel], map.texels[i][channel]);
        }
    }
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_GE(split->sun.irradiance[channel], 0.0);
}

TEST(SunSplit, NoSunNoSplit) {
    EXPECT_FALSE(split_sun(data_gen::two_soft_boxes(64)));
    EXPECT_FALSE(split_sun(data_gen::constant(64)));
}

TEST(SunSplit, LatLongImages) {
    const cubemap::CubeMap map = data_gen::sun_and_sky(
        256, {.sun_elevation_degrees = 30.0, .sun_azimuth_degrees = 180.0}); // on the seam
    for (const cubemap::Sampling sampling :
         {cubemap::Sampling::TexelCentres, cubemap::Sampling::Borders}) {
        const cubemap::EnvironmentImage image =
            cubemap::to_image(map, cubemap::Layout::LatLong, 1024, 512, sampling);
        const auto split = split_sun(image);
        ASSERT_TRUE(split);
        EXPECT_LT(worst_error(image, *split), 1e-3);
        EXPECT_LT(glm::distance(split->sun.direction, data_gen::direction_from_angles(30.0, 180.0)),
                  2e-3);
    }
}

TEST(SunSplit, MeasuredSuns) {
    for (const char* name : {"latlong/sunset_1k.hdr", "latlong/blender_sunset_1k.exr",
                             "openexr/KernerEnvLatLong.exr", "openexr/KernerEnvCube.exr"}) {
        const std::filesystem::path path = real_data(std::filesystem::path("envs") / name);
        if (path.empty())
            GTEST_SKIP() << absent_data(name);
        const cubemap::EnvironmentImage image =
            cubemap::load_environment(path, {.fix_bad_pixels = true});
        const auto split = split_sun(image);
        ASSERT_TRUE(split) << name;
        EXPECT_LT(worst_error(image, *split), 1e-3) << name;
    }
}

TEST(SunSplit, SameForAnyNumberOfThreads) {
    const cubemap::CubeMap map = data_gen::sun_and_sky(128);
    const cubemap::EnvironmentImage image =
        cubemap::to_image(map, cubemap::Layout::LatLong, 512, 256);
    const auto all = split_sun(image);
    const files::ThreadLimit one(1);
    const auto single = split_sun(image);
    ASSERT_TRUE(all && single);
    EXPECT_EQ(all->sun.direction, single->sun.direction);
    EXPECT_EQ(all->sun.irradiance, single->sun.irradiance);
    EXPECT_EQ(all->sun.solid_angle, single->sun.solid_angle);
    EXPECT_EQ(all->rest.pixels, single->rest.pixels);
}

} // namespace
} // namespace relumine::lights
