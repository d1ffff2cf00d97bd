#include "relight/sharp/sharp_lights.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <tuple>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "relight/reference/exact.h"
#include "relight/relighter.h"
#include "relight/sharp/light_packets.h"
#include "tests/relight/environments.h"
#include "tests/relight/relit_scene.h"

namespace relumine::relight {
namespace {

std::vector<SharpLight> sharp_lights(const cubemap::CubeMap& environment,
                                     float tolerance = 0.0135f) {
    const LightBinning binning(environment.resolution);
    const auto cells = scenes::relit_scene().transfer.quadtree.leaves();
    std::vector<double> powers;
    for (const VectorIrradiance& sum : binning.sums(environment, cells))
        powers.push_back(glm::length(sum.luminance()));
    return find_sharp_lights(environment, binning, cells, powers, tolerance);
}

cubemap::CubeMap sky_with_sun(std::uint32_t r, cubemap::Face face, std::uint32_t x, std::uint32_t y,
                              float sun) {
    cubemap::CubeMap environment(r, glm::vec3(0.3f, 0.5f, 1.0f));
    environment.at(face, x, y) = sun * glm::vec3(1.0f, 0.9f, 0.8f);
    return environment;
}

TEST(SharpLights, LargeSourcesHaveNone) {
    EXPECT_TRUE(sharp_lights(cubemap::CubeMap(64)).empty());
    EXPECT_TRUE(sharp_lights(cubemap::CubeMap(64, glm::vec3(5.0f))).empty());
    EXPECT_TRUE(sharp_lights(scenes::smooth_environment(64)).empty());
}

TEST(SharpLights, TheSunIsOne) {
    const cubemap::CubeMap environment = sky_with_sun(128, cubemap::Face::PositiveX, 40, 50, 1e5f);
    const std::vector<SharpLight> lights = sharp_lights(environment);
    ASSERT_FALSE(lights.empty());
    double power = 0.0;
    for (const SharpLight& light : lights)
        power += glm::length(light.irradiance.red);
    const auto sun = std::max_element(
        lights.begin(), lights.end(), [](const SharpLight& a, const SharpLight& b) {
            return glm::length(a.irradiance.red) < glm::length(b.irradiance.red);
        });
    const double n = 128.0;
    const double expected = 1e5 * cubemap::solid_angle(40 / n, 50 / n, 41 / n, 51 / n);
    EXPECT_NEAR(glm::length(sun->irradiance.red), expected, 1e-6 * expected);
    EXPECT_LT(power, 1.01 * expected)
        << "only what surrounds the sun within its cell may come along";
    const glm::dvec3 w = cubemap::texel_direction(cubemap::Face::PositiveX, 40, 50, 128);
    EXPECT_LT(glm::length(sun->direction - w), 1e-6);
    EXPECT_TRUE(std::is_sorted(lights.begin(), lights.end(),
                               [](const auto& a, const auto& b) { return a.cluster < b.cluster; }));
    EXPECT_TRUE(sharp_lights(environment, 0.0f).empty()) << "an exact precompute needs none";
}

TEST(SharpLights, PicturesTraceFewOfAnEnvironmentAndAllOfAList) {
    const scenes::RelitScene& scene = scenes::relit_scene();
    ShadowRays rays = scene.shadow_rays();
    rays.tolerance = 0.2f; // as if clusters were few: most lamps are too small for theirs
    Relighter relighter(scene.transfer, rays);
    relighter.set_environment(sky_with_sun(128, cubemap::Face::PositiveX, 40, 50, 1e5f));
    ASSERT_FALSE(relighter.sharp_lights().empty());
    EXPECT_EQ(picture_lights(relighter).size(), relighter.sharp_lights().size());
    // Suns all over the sky.
    cubemap::CubeMap lamps(128, glm::vec3(0.3f));
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t i = 0; i < 25; ++i)
            lamps.at(face, 12 + 25 * (i % 5), 12 + 25 * (i / 5)) = glm::vec3(1e4f);
    relighter.set_environment(lamps);
    EXPECT_GT(relighter.sharp_lights().size(), 40u);
    EXPECT_LE(relighter.sharp_lights().size(), 64u) << "the strongest of 150";
    EXPECT_EQ(picture_lights(relighter).size(), relighter.sharp_lights().size());
    std::vector<lights::DistantLight> list(100);
    for (std::size_t i = 0; i < list.size(); ++i) {
        const double angle = 0.01 * static_cast<double>(i);
        list[i] = {.direction = glm::dvec3(std::sin(angle), std::cos(angle), 0.0),
                   .irradiance = glm::dvec3(0.1)};
    }
    relighter.set_lights(list);
    EXPECT_EQ(picture_lights(relighter).size(), list.size());
}

TEST(SharpLights, OfManyTheStrongestAreCutWhereTheyAreWide) {
    // Under clusters as wide as faces: a wide lamp, a sun, and many weak lamps.
    cubemap::CubeMap map(256);
    for (std::uint32_t y = 64; y < 128; ++y)
        for (std::uint32_t x = 64; x < 128; ++x)
            map.at(cubemap::Face::PositiveZ, x, y) = glm::vec3(100.0f);
    map.at(cubemap::Face::PositiveX, 40, 50) = glm::vec3(1e5f);
    for (std::uint32_t i = 0; i < 100; ++i)
        map.at(cubemap::Face::PositiveY, 3 + 25 * (i % 10), 3 + 25 * (i / 10)) = glm::vec3(500.0f);
    std::vector<prt::Cell> clusters;
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t i = 0; i < 64; ++i)
            clusters.push_back({face, 3, i % 8, i / 8});
    const LightBinning binning(256);
    std::vector<double> powers;
    for (const prt::Cell& cell : clusters)
        powers.push_back(binning.sum(map, cell).power());
    const std::vector<SharpLight> all = find_sharp_lights(map, binning, clusters, powers, 10.0f,
                                                          true),
                                  few = find_sharp_lights(map, binning, clusters, powers, 10.0f);
    ASSERT_GT(all.size(), 64u);
    EXPECT_LE(few.size(), 64u);
    EXPECT_GE(few.size(), 48u) << "as many cells are kept";
    EXPECT_TRUE(std::is_sorted(few.begin(), few.end(),
                               [](const auto& a, const auto& b) { return a.cluster < b.cluster; }));
    // All light of each light's cell, and the sun among them.
    const glm::dvec3 sun = cubemap::texel_direction(cubemap::Face::PositiveX, 40, 50, 256);
    bool has_sun = false;
    for (const SharpLight& light : few) {
        const VectorIrradiance expected = binning.sum(map, light.cell);
        EXPECT_EQ(light.irradiance, expected);
        has_sun = has_sun || glm::distance(light.direction, sun) < 1e-6;
    }
    EXPECT_TRUE(has_sun);
}

// Stored highlights show the lights themselves. Where rays find highlights they see the rest.
TEST(SharpLights, StoredHighlightsNeedMoreThanTracedOnes) {
    prt::Transfer transfer;
    transfer.quadtree = scenes::relit_scene().transfer.quadtree;
    cubemap::CubeMap map(256);
    for (std::uint32_t y = 64; y < 128; ++y)
        for (std::uint32_t x = 64; x < 128; ++x)
            map.at(cubemap::Face::PositiveZ, x, y) = glm::vec3(100.0f);
    const LightBinning binning(256);
    std::vector<double> powers;
    for (const prt::Cell& cell : transfer.quadtree.leaves())
        powers.push_back(binning.sum(map, cell).power());
    const auto num_lights = [&] {
        return find_sharp_lights(map, binning, transfer, powers, 10.0f).size();
    };
    const std::size_t matt = num_lights();
    EXPECT_LE(matt, 64u);
    transfer.glossy.emplace();
    EXPECT_FALSE(transfer.glossy->is_stored());
    EXPECT_EQ(num_lights(), matt);
    transfer.glossy->lobes[0].cells = {0};
    EXPECT_TRUE(transfer.glossy->is_stored());
    EXPECT_GT(num_lights(), 64u);
}

TEST(SharpLights, LightsOfOneSmallCellBecomeOne) {
    const LightBinning binning(512);
    const cubemap::CubeMap white(512, glm::vec3(1.0f));
    std::vector<SharpLight> lights;
    VectorIrradiance all;
    const std::function<void(const prt::Cell&)> add = [&](const prt::Cell& cell) {
        if (cell.level < 9) {
            for (std::uint32_t i = 0; i < 4; ++i)
                add(cell.child(i));
            return;
        }
        lights.push_back({.cell = cell, .irradiance = binning.sum(white, cell)});
        all += lights.back().irradiance;
    };
    add({cubemap::Face::PositiveZ, 5, 7, 9});
    ASSERT_EQ(lights.size(), 256u);
    EXPECT_EQ(merged(lights, 256).size(), 256u);
    const std::vector<SharpLight> few = merged(lights, 64);
    EXPECT_EQ(few.size(), 64u);
    EXPECT_EQ(merged(lights, 63).size(), 16u);
    EXPECT_TRUE(merged(lights, 15).empty()) << "that is too wide for shadows of one point";
    VectorIrradiance sum;
    for (const SharpLight& light : few) {
        sum += light.irradiance;
        const double size = light.cell.size();
        const glm::dvec3 middle = cubemap::direction(light.cell.face, (light.cell.x + 0.5) * size,
                                                     (light.cell.y + 0.5) * size);
        EXPECT_GT(glm::dot(light.direction, middle), std::cos(0.001));
    }
    EXPECT_LT(glm::length(sum.green - all.green), 1e-12 * glm::length(all.green));
}

TEST(SharpLights, ASunIsAsSharpAsTracing) {
    // Nearly all light from one texel of 0.9 degrees: all of it traced. What remains is the sky's
    // error.
    const scenes::RelitScene& scene = scenes::relit_scene();
    std::vector<std::uint32_t> all(scene.receivers.size());
    for (std::uint32_t i = 0; i < all.size(); ++i)
        all[i] = i;
    for (const auto& [face, x, y] : {std::tuple(cubemap::Face::PositiveX, 40u, 50u),
                                     {cubemap::Face::PositiveY, 80u, 30u},
                                     {cubemap::Face::NegativeZ, 3u, 20u}}) {
        const cubemap::CubeMap environment = sky_with_sun(128, face, x, y, 1e6f);
        const auto exact = exact_radiance(scene.receivers, all, scene.rays, environment,
                                          {.bias = scene.options.bias});
        const auto traced =
            compare(all, exact, relight(scene.transfer, environment, scene.shadow_rays()));
        const auto clustered = compare(all, exact, relight(scene.transfer, environment));
        EXPECT_LT(traced.relative_l2, 1e-3);
        EXPECT_LT(traced.relative_l2, 0.1 * clustered.relative_l2);
    }
}

TEST(SharpLights, PacketsAddUpEveryLightAboveTheHorizonThatNothingBlocks) {
    const scenes::RelitScene& scene = scenes::relit_scene();
    std::vector<SharpLight> lights;
    std::mt19937 random(1);
    for (int i = 0; i < 37; ++i) {
        const glm::dvec3 w = scenes::random_direction(random);
        lights.push_back(
            {.direction = w, .irradiance = {.red = 2.0 * w, .green = w, .blue = 0.0 * w}});
    }
    const LightPackets packets(lights);
    const ShadowRays rays = scene.shadow_rays();
    for (std::size_t i = 0; i < scene.receivers.size(); ++i) {
        const glm::vec3& n = scene.receivers.normals[i];
        const glm::vec3 origin = prt::ray_origin(scene.receivers.positions[i], n, rays.bias);
        double expected = 0.0;
        for (const SharpLight& light : lights)
            if (!scene.rays.occluded(origin, glm::vec3(light.direction)))
                expected +=
                    std::max(0.0, glm::dot(glm::dvec3(n), light.direction)) / std::numbers::pi;
        const glm::dvec3 radiance = packets.radiance(scene.receivers.positions[i], n, rays);
        EXPECT_NEAR(radiance.r, 2.0 * expected, 1e-6);
        EXPECT_NEAR(radiance.g, expected, 1e-6);
        EXPECT_EQ(radiance.b, 0.0);
    }
    EXPECT_EQ(LightPackets(std::span<const SharpLight>()).radiance({}, {0, 1, 0}, rays),
              glm::dvec3(0.0));
}

} // namespace
} // namespace relumine::relight
