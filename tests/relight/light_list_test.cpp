// Lighting with distant lights: traced, through the clusters, and lights chosen for a scene.
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "files/parallel.h"
#include "lights/place_lights.h"
#include "relight/light_fit/transfer_lights.h"
#include "relight/reference/exact.h"
#include "relight/relighter.h"
#include "relight/sharp/light_packets.h"
#include "tests/relight/environments.h"
#include "tests/relight/relit_scene.h"

namespace relumine::relight {
namespace {

using lights::DistantLight;
using scenes::relit_scene;

std::vector<DistantLight> random_lights(std::mt19937& random, std::size_t count) {
    std::normal_distribution<double> coordinate;
    std::uniform_real_distribution<double> irradiance(0.0, 2.0);
    std::vector<DistantLight> lights(count);
    for (DistantLight& light : lights) {
        light.direction =
            glm::normalize(glm::dvec3(coordinate(random), coordinate(random), coordinate(random)));
        light.irradiance = {irradiance(random), irradiance(random), irradiance(random)};
    }
    return lights;
}

std::vector<std::uint32_t> all_receivers() {
    std::vector<std::uint32_t> all(relit_scene().receivers.size());
    std::iota(all.begin(), all.end(), 0u);
    return all;
}

double relative_l2(std::span<const glm::dvec3> expected, std::span<const glm::vec3> radiance) {
    double difference = 0.0;
    double norm = 0.0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const glm::dvec3 d = glm::dvec3(radiance[i]) - expected[i];
        difference += glm::dot(d, d);
        norm += glm::dot(expected[i], expected[i]);
    }
    return std::sqrt(difference / norm);
}

// One ray at a time, nothing shared.
TEST(LightPackets, EqualOneShadowRayPerLightAndReceiver) {
    std::mt19937 random(1);
    const scenes::RelitScene& scene = relit_scene();
    const std::vector<DistantLight> lights =
        random_lights(random, 37); // two packets and a part of one
    const std::vector<std::uint32_t> receivers = all_receivers();
    const std::vector<glm::dvec3> radiance =
        radiance_under(lights, scene.receivers.normals, receivers, scene.shadow_rays());
    std::size_t num_shadows = 0;
    for (std::size_t i = 0; i < receivers.size(); i += 7) {
        const glm::vec3& normal = scene.receivers.normals[i];
        glm::dvec3 expected(0.0);
        for (const DistantLight& light : lights) {
            const double cosine = glm::dot(glm::dvec3(normal), light.direction);
            if (cosine <= 0.0)
                continue;
            prt::DirectionPacket one;
            for (std::size_t lane = 0; lane < prt::PacketSize; ++lane)
                one.set(lane, light.direction);
            one.num_directions = 1;
            const glm::vec3 origin =
                prt::ray_origin(scene.receivers.positions[i], normal, scene.options.bias);
            const bool blocked = scene.rays.occluded(origin, one, 1u) != 0;
            num_shadows += static_cast<std::size_t>(blocked);
            expected += blocked ? glm::dvec3(0.0) : light.irradiance * cosine / std::numbers::pi;
        }
        EXPECT_NEAR(glm::length(radiance[i] - expected), 0.0, 1e-6 * glm::length(expected) + 1e-12);
    }
    EXPECT_GT(num_shadows, 100u);
}

TEST(LightPackets, RefuseIndicesAndSizesThatDoNotFit) {
    const scenes::RelitScene& scene = relit_scene();
    const std::vector<DistantLight> lights(1);
    const std::vector<glm::vec3>& normals = scene.receivers.normals;
    const std::vector<std::uint32_t> beyond = {static_cast<std::uint32_t>(normals.size())};
    EXPECT_THROW(static_cast<void>(radiance_under(lights, normals, beyond, scene.shadow_rays())),
                 std::invalid_argument);
    EXPECT_THROW(static_cast<void>(radiance_under(lights, normals, ShadowRays{})),
                 std::invalid_argument);
    EXPECT_THROW(
        static_cast<void>(radiance_under(lights, std::span(normals).first(1), scene.shadow_rays())),
        std::invalid_argument);
}

TEST(RelighterLights, WithShadowRaysEqualTracing) {
    std::mt19937 random(2);
    const scenes::RelitScene& scene = relit_scene();
    const std::vector<DistantLight> lights = random_lights(random, 50);
    Relighter relighter(scene.transfer, scene.shadow_rays());
    const UpdateReport times = relighter.set_lights(lights);
    EXPECT_EQ(times.num_sharp_lights, 50u);
    EXPECT_LT(relative_l2(radiance_under(lights, scene.receivers.normals, all_receivers(),
                                         scene.shadow_rays()),
                          relighter.radiance()),
              1e-6);
}

// A light at every texel, through the clusters, is the environment itself, whatever its clusters
// make of it.
TEST(RelighterLights, ThroughTheClustersALightPerTexelIsTheEnvironment) {
    const scenes::RelitScene& scene = relit_scene();
    const cubemap::CubeMap environment = scenes::smooth_environment(64);
    const std::vector<double> solid_angles = cubemap::texel_solid_angles(64);
    std::vector<DistantLight> lights;
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < 64; ++y)
            for (std::uint32_t x = 0; x < 64; ++x)
                lights.push_back({.direction = cubemap::texel_direction(face, x, y, 64),
                                  .irradiance = glm::dvec3(environment.at(face, x, y)) *
                                                solid_angles[y * 64 + x]});
    Relighter of_lights(scene.transfer);
    of_lights.set_lights(lights);
    const std::vector<glm::vec3> expected = relight(scene.transfer, environment);
    const std::vector<glm::dvec3> of_map(expected.begin(), expected.end());
    EXPECT_LT(relative_l2(of_map, of_lights.radiance()), 2e-4);
}

TEST(RelighterLights, AnEnvironmentAfterwardsIsAsIfThereHadBeenNone) {
    std::mt19937 random(3);
    const scenes::RelitScene& scene = relit_scene();
    const cubemap::CubeMap environment = scenes::smooth_environment(32);
    Relighter relighter(scene.transfer, scene.shadow_rays());
    relighter.set_lights(random_lights(random, 20));
    relighter.set_environment(environment);
    const std::vector<glm::vec3> fresh = relight(scene.transfer, environment, scene.shadow_rays());
    EXPECT_TRUE(std::equal(fresh.begin(), fresh.end(), relighter.radiance().begin()));
}

TEST(RelighterLights, RefusesWhatIsNoLight) {
    Relighter relighter(relit_scene().transfer);
    const auto refused = [&](const DistantLight& light) {
        EXPECT_THROW(relighter.set_lights(std::vector{light}), std::invalid_argument);
    };
    refused({.direction = {0.0, 2.0, 0.0}, .irradiance = glm::dvec3(1.0)});
    refused({.direction = glm::dvec3(std::nan("")), .irradiance = glm::dvec3(1.0)});
    refused({.irradiance = {1.0, -1.0, 1.0}});
    refused({.irradiance = {1.0, std::nan(""), 1.0}});
    relighter.set_lights({});
    for (const glm::vec3& radiance : relighter.radiance())
        EXPECT_EQ(radiance, glm::vec3(0.0f));
    EXPECT_THROW(update_region(relighter, {.x1 = 1, .y1 = 1}, std::vector{glm::vec3(1.0f)}),
                 std::invalid_argument);
}

/// The error of a light list on the test scene, and of others, against exact integration.
struct Comparison {
    Relighter relighter{relit_scene().transfer, relit_scene().shadow_rays()};
    std::vector<glm::dvec3> exact;

    explicit Comparison(const cubemap::CubeMap& environment) {
        relighter.set_environment(environment);
        exact = exact_radiance(relit_scene().receivers, all_receivers(), relit_scene().rays,
                               environment, {.bias = relit_scene().options.bias});
    }

    [[nodiscard]] double error(std::span<const DistantLight> lights) const {
        const std::vector<glm::dvec3> radiance = radiance_under(
            lights, relit_scene().receivers.normals, all_receivers(), relit_scene().shadow_rays());
        return relative_l2(exact, std::vector<glm::vec3>(radiance.begin(), radiance.end()));
    }
};

TEST(TransferLights, AreBetterThanLightsThatDoNotKnowTheScene) {
    const cubemap::CubeMap environment = scenes::smooth_environment(64);
    const Comparison comparison(environment);
    double last = 1.0;
    for (const std::size_t count : {4u, 16u, 64u}) {
        const std::vector<DistantLight> chosen = transfer_lights(comparison.relighter, count);
        EXPECT_LE(chosen.size(), count);
        const double error = comparison.error(chosen);
        EXPECT_LT(error, 0.6 * comparison.error(lights::place_lights(lights::Method::MedianCut,
                                                                     environment, count)))
            << count << " lights";
        EXPECT_LT(error, last);
        last = error;
    }
}

TEST(TransferLights, AFewRealLightsAreFound) {
    // Three lit texels: three lights light the scene like the map does.
    cubemap::CubeMap environment(64);
    environment.at(cubemap::Face::PositiveY, 20, 40) = {900.0f, 800.0f, 700.0f};
    environment.at(cubemap::Face::PositiveX, 31, 10) = {0.0f, 500.0f, 100.0f};
    environment.at(cubemap::Face::NegativeZ, 50, 5) = {300.0f, 0.0f, 900.0f};
    const Comparison comparison(environment);
    const std::vector<DistantLight> chosen = transfer_lights(comparison.relighter, 3);
    ASSERT_EQ(chosen.size(), 3u);
    EXPECT_LT(comparison.error(chosen), 0.02);
    const glm::dvec3 power = cubemap::total_power(environment);
    EXPECT_NEAR(glm::length(lights::total_irradiance(chosen) - power), 0.0,
                0.03 * glm::length(power));
}

TEST(TransferLights, SameForAnyNumberOfThreads) {
    const Comparison comparison(scenes::smooth_environment(32));
    const std::vector<DistantLight> two = transfer_lights(comparison.relighter, 12);
    const files::ThreadLimit control(1);
    const std::vector<DistantLight> one = transfer_lights(comparison.relighter, 12);
    ASSERT_EQ(one.size(), two.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].direction, two[i].direction);
        EXPECT_EQ(one[i].irradiance, two[i].irradiance);
    }
}

TEST(TransferLights, OddInputs) {
    Relighter relighter(relit_scene().transfer, relit_scene().shadow_rays());
    EXPECT_THROW(static_cast<void>(transfer_lights(relighter, 4)), std::invalid_argument);
    relighter.set_environment(cubemap::CubeMap(16));
    EXPECT_TRUE(transfer_lights(relighter, 4).empty());
    EXPECT_THROW(static_cast<void>(transfer_lights(relighter, 0)), std::invalid_argument);
    Relighter without_rays(relit_scene().transfer);
    without_rays.set_environment(cubemap::CubeMap(16, glm::vec3(1.0f)));
    EXPECT_THROW(static_cast<void>(transfer_lights(without_rays, 4)), std::invalid_argument);
}

} // namespace
} // namespace relumine::relight
