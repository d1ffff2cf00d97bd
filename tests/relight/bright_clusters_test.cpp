#include "relight/bright_clusters.h"

#include <algorithm>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "relight/receiver_light.h"
#include "tests/relight/environments.h"
#include "tests/relight/relit_scene.h"

namespace relumine::relight {
namespace {

constexpr glm::vec3 Up(0.0f, 1.0f, 0.0f);

/// A grey sky with a square light around the zenith, and a lamp of one texel in it.
cubemap::CubeMap sky_with_box() {
    cubemap::CubeMap sky(64, glm::vec3(0.05f));
    for (std::uint32_t y = 16; y < 48; ++y)
        for (std::uint32_t x = 16; x < 48; ++x)
            sky.at(cubemap::Face::PositiveY, x, y) = {20.0f, 18.0f, 16.0f};
    sky.at(cubemap::Face::PositiveY, 30, 29) *= 50.0f;
    return sky;
}

TEST(BrightClusters, EvenSkiesHaveNone) {
    const scenes::RelitScene& scene = scenes::relit_scene();
    Relighter relighter(scene.transfer, scene.shadow_rays());
    EXPECT_TRUE(bright_clusters(relighter, Up).lights.empty()) << "there is no light";
    relighter.set_environment(scenes::smooth_environment(64));
    EXPECT_TRUE(bright_clusters(relighter, Up).lights.empty());
}

TEST(BrightClusters, CellsHaveTheLightOfTheirClustersWithoutTheSharp) {
    const scenes::RelitScene scene(0.15f);
    ShadowRays rays = scene.shadow_rays();
    rays.tolerance = 0.02f; // or the box would be sharp
    Relighter relighter(scene.transfer, rays);
    relighter.set_environment(sky_with_box());
    ASSERT_FALSE(relighter.sharp_lights().empty());
    const BrightClusters bright = bright_clusters(relighter, Up);
    ASSERT_FALSE(bright.clusters.empty());
    EXPECT_GT(bright.lights.size(), bright.clusters.size()) << "large cells are cut";
    EXPECT_TRUE(std::is_sorted(bright.clusters.begin(), bright.clusters.end()));
    glm::dvec3 expected(0.0), sum(0.0);
    for (const std::uint32_t cluster : bright.clusters)
        expected += relighter.cluster_light(cluster).on(Up);
    for (const SharpLight& light : bright.lights) {
        EXPECT_NEAR(glm::length(light.direction), 1.0, 1e-9);
        sum += light.irradiance.on(Up);
    }
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(sum[channel], expected[channel], 1e-4 * expected[channel]);
    EXPECT_GT(expected.r, 10.0) << "|x / y| and |z / y| are below 1/2 in the box";
}

TEST(BrightClusters, AllClustersGiveTheSoftRadiance) {
    const scenes::RelitScene& scene = scenes::relit_scene();
    Relighter relighter(scene.transfer, scene.shadow_rays());
    relighter.set_environment(sky_with_box());
    std::vector<std::uint32_t> all(scene.transfer.num_clusters());
    for (std::uint32_t i = 0; i < all.size(); ++i)
        all[i] = i;
    const std::vector<glm::vec3> soft = relighter.receiver_light().soft_radiance();
    constexpr std::size_t First = 100;
    scenes::expect_close(radiance_from(all, relighter, First), std::span(soft).subspan(First),
                         0.01);
}

} // namespace
} // namespace relumine::relight
