#include "relumine/light/edits.h"
#include "relumine/light/lit_scene.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "cubemap/layers/layer_composite.h"
#include "relight/sharp/shadow_rays.h"
#include "relumine/ask/questions.h"
#include "relumine/out/output.h"
#include "tests/relight/arrays.h"
#include "tests/relight/environments.h"
#include "tests/relumine/small_scenes.h"

namespace relumine {
namespace {

const Scene& boulder_scene() {
    static const Scene Boulder =
        precompute(scenes::boulder(), {.tolerance = scenes::Tolerance, .bounce_tolerance = 0.0f});
    return Boulder;
}

using relight::copy;

std::vector<glm::vec3> lit(const cubemap::CubeMap& map) {
    LitScene scene(boulder_scene());
    scene.light(map);
    return copy(scene.radiance());
}

cubemap::LightLayer disc(const glm::dvec3& direction, float radiance) {
    return {.name = "disc",
            .region = cubemap::Disc{.direction = direction, .radius_degrees = 20.0},
            .effect = cubemap::Emit{.radiance = glm::vec3(radiance)}};
}

TEST(LitScene, LightsAsTheRelighterDoes) {
    const cubemap::CubeMap map = scenes::random_environment(16, 1);
    LitScene scene(boulder_scene());
    EXPECT_TRUE(scene.radiance().empty());
    scene.light(map);
    EXPECT_EQ(copy(scene.radiance()),
              relight::relight(scene.scene().transfer, map, scene.relighter().shadow_rays()));
    EXPECT_EQ(environment_of(scene).texels, map.texels);
    EXPECT_EQ(scene.relighter().shadow_rays().bias, boulder_scene().settings.bias);
    EXPECT_EQ(scene.relighter().shadow_rays().tolerance, scenes::Tolerance);
}

TEST(LitScene, MayBeMovedWhileLit) {
    const cubemap::CubeMap map = scenes::random_environment(16, 2);
    std::optional<LitScene> first(boulder_scene());
    first->light(map);
    Painter painter(*first, {.width = 8, .height = 6});
    LitScene second = std::move(*first);
    first.reset();
    const Picture picture = painter.draw(second.lighting());
    EXPECT_EQ(picture.pixels, draw(second, {.width = 8, .height = 6}).pixels);
    set_layers(second, {disc({1, 1, 0}, 3.0f)});
    LitScene third(boulder_scene());
    third = std::move(second);
    set_layers(third, {});
    scenes::expect_close(third.radiance(), lit(map), 1e-5);
}

TEST(LitScene, UpdatesARegionUnderLayersOrWithout) {
    const cubemap::CubeMap map = scenes::random_environment(16, 3);
    const cubemap::TexelRectangle rectangle{cubemap::Face::PositiveY, 2, 3, 7, 9};
    const std::vector<glm::vec3> bright(5 * 6, glm::vec3(9.0f));
    cubemap::CubeMap changed = map;
    for (std::uint32_t y = 3; y < 9; ++y)
        for (std::uint32_t x = 2; x < 7; ++x)
            changed.at(cubemap::Face::PositiveY, x, y) = glm::vec3(9.0f);

    LitScene scene(boulder_scene());
    scene.light(map);
    EXPECT_GT(scene.environment().update_region(rectangle, bright).num_clusters, 0u);
    EXPECT_EQ(environment_of(scene).texels, changed.texels);
    scenes::expect_close(scene.radiance(), lit(changed), 1e-5);

    const std::vector<cubemap::LightLayer> layers = {disc({0, 1, 1}, 2.0f)};
    LitScene layered(boulder_scene());
    layered.light(map);
    set_layers(layered, layers);
    layered.environment().update_region(rectangle, bright);
    LitScene expected(boulder_scene());
    expected.light(changed);
    set_layers(expected, layers);
    EXPECT_EQ(environment_of(layered).texels, environment_of(expected).texels);
    scenes::expect_close(layered.radiance(), expected.radiance(), 1e-5);
}

TEST(LitScene, RefusesARegionThatDoesNotFit) {
    LitScene scene(boulder_scene());
    const std::vector<glm::vec3> four(4, glm::vec3(1.0f));
    const cubemap::TexelRectangle inside{cubemap::Face::PositiveY, 0, 0, 2, 2};
    EXPECT_THROW(scene.environment().update_region(inside, four),
                 std::invalid_argument); // nothing to update
    scene.light(scenes::random_environment(4, 1));
    for (int with_layers = 0; with_layers < 2; ++with_layers) {
        EXPECT_THROW(
            scene.environment().update_region({cubemap::Face::PositiveY, 3, 0, 5, 2}, four),
            std::invalid_argument);
        EXPECT_THROW(scene.environment().update_region({cubemap::Face::PositiveY, 2, 0, 2, 2}, {}),
                     std::invalid_argument);
        EXPECT_THROW(scene.environment().update_region(inside, std::span(four).first(3)),
                     std::invalid_argument);
        set_layers(scene, {disc({1, 0, 0}, 1.0f)});
    }
}

TEST(LitScene, KeepsItsLayersUnderANewEnvironment) {
    const cubemap::CubeMap first = scenes::random_environment(16, 4);
    const cubemap::CubeMap second = scenes::random_environment(16, 5);
    const std::vector<cubemap::LightLayer> layers = {disc({0, 1, 0}, 5.0f), disc({1, 0, 1}, 7.0f)};
    LitScene scene(boulder_scene());
    EXPECT_THROW(set_layers(scene, layers), std::invalid_argument); // no environment yet
    scene.light(first);
    set_layers(scene, {layers[0], disc({1, 0, 1}, 1.0f)});
    set_layer(scene, 1, layers[1]);
    EXPECT_EQ(scene.environment().state().layers, layers);
    scene.light(second);
    EXPECT_EQ(environment_of(scene).texels, cubemap::composite(second, layers).texels);
    EXPECT_EQ(copy(scene.radiance()), lit(environment_of(scene)));
    EXPECT_THROW(set_layer(scene, 2, layers[0]), std::out_of_range);
}

TEST(LitScene, UndoesToAMark) {
    LitScene scene(boulder_scene());
    scene.light(scenes::random_environment(16, 6));
    const std::vector<glm::vec3> plain = copy(scene.radiance());
    mark(scene);
    set_layers(scene, {disc({0, 1, 0}, 5.0f)});
    mark(scene);
    EXPECT_NE(copy(scene.radiance()), plain);
    undo(scene);
    EXPECT_EQ(copy(scene.radiance()), plain);
}

TEST(LitScene, TakesLightLists) {
    const std::vector<lights::DistantLight> list = {
        {.direction = {0, 1, 0}, .irradiance = glm::dvec3(2.0)},
        {.direction = {0.6, 0.8, 0}, .irradiance = {1.0, 0.5, 0.25}}};
    LitScene scene(boulder_scene());
    scene.light(scenes::random_environment(8, 7));
    set_layers(scene, {disc({0, 1, 0}, 5.0f)});
    scene.light(list);
    const std::vector<glm::vec3> expected = relight::radiance_under(
        list, scene.scene().receivers.normals, scene.relighter().shadow_rays());
    scenes::expect_close(scene.radiance(), expected, 1e-6);
    EXPECT_EQ(cubemap::total_power(environment_of(scene)), glm::dvec3(0.0));
    EXPECT_THROW(set_layers(scene, {}), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(verify(scene)), std::logic_error);

    // A mesh without clusters gives the same.
    LitScene mesh(unclustered_scene(scenes::boulder()));
    EXPECT_FALSE(has_clusters(mesh.scene()));
    mesh.light(list);
    EXPECT_EQ(copy(mesh.radiance()), expected);
    EXPECT_EQ(draw(mesh, {.width = 8, .height = 6}).pixels.size(), 48u);
    EXPECT_THROW(mesh.light(cubemap::CubeMap(4)), std::invalid_argument);
    EXPECT_THROW(set_layers(mesh, {}), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(mesh.relighter()), std::invalid_argument);
}

TEST(LitScene, LightsThroughClustersOnlyWhenAsked) {
    cubemap::CubeMap sun(256);
    sun.at(cubemap::Face::PositiveY, 100, 90) = glm::vec3(1e5f);
    LitScene traced(boulder_scene());
    EXPECT_GT(traced.light(sun).num_sharp_lights, 0u);
    LitScene clusters(boulder_scene(), {.clusters_only = true});
    EXPECT_EQ(clusters.light(sun).num_sharp_lights, 0u);
    EXPECT_EQ(copy(clusters.radiance()), relight::relight(clusters.scene().transfer, sun));
    EXPECT_THROW(LitScene(unclustered_scene(scenes::boulder()), {.clusters_only = true}),
                 std::invalid_argument);
}

TEST(LitScene, RefusesATransferOfOtherReceivers) {
    Scene scene = boulder_scene();
    scene.receivers = {};
    EXPECT_THROW(LitScene{std::move(scene)}, std::invalid_argument);
}

TEST(LitScene, SaysWhatItNeedsBeforeItIsLit) {
    const LitScene scene(boulder_scene());
    EXPECT_THROW(static_cast<void>(scene.lighting()), std::logic_error);
    EXPECT_THROW(static_cast<void>(draw(scene)), std::logic_error);
    EXPECT_THROW(save(scene, "absent.png"), std::logic_error);
    EXPECT_THROW(static_cast<void>(verify(scene)), std::logic_error);
    EXPECT_THROW(static_cast<void>(lit_by(scene, cubemap::Disc{})), std::logic_error);
    EXPECT_EQ(environment_of(scene).resolution, 0u);
}

TEST(LitScene, IsVerifiedByExactIntegration) {
    LitScene scene(boulder_scene());
    scene.light(scenes::smooth_environment(16));
    const Verification some = verify(scene, {.num_samples = 40, .seed = 3});
    EXPECT_EQ(some.receivers, relight::random_receivers(scene.scene().transfer, 40, 3));
    EXPECT_GT(some.error.relative_l2, 0.0);
    EXPECT_LT(some.error.relative_l2, 0.05);
    EXPECT_EQ(verify(scene, {.num_samples = 0}).receivers.size(), scene.radiance().size());

    // Points of the surface, which may be far more than receivers, have their part of the progress.
    std::vector<double> told;
    static_cast<void>(
        verify(scene, {.num_samples = 10, .num_surface_points = 90}, {.on_progress = [&](double f) {
                   told.push_back(f);
               }}));
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    ASSERT_FALSE(told.empty());
    EXPECT_NEAR(told.back(), 1.0, 1e-9);
    EXPECT_LT(told.front(), 0.1);

    std::stop_source stop;
    stop.request_stop();
    EXPECT_THROW(static_cast<void>(verify(scene, {}, {.stop = stop.get_token()})), Cancelled);
}

TEST(LitScene, BouncesUntilTheLightChanges) {
    LitScene scene(
        precompute(scenes::boulder(), {.tolerance = scenes::Tolerance, .bounce_tolerance = 0.05f}));
    const std::vector<glm::vec3> albedo(scene.scene().receivers.size(), glm::vec3(0.5f));
    EXPECT_THROW(scene.bounce({.albedo = albedo}), std::logic_error);
    const cubemap::CubeMap white(8, glm::vec3(1.0f));
    scene.light(white);
    const std::vector<glm::vec3> direct(scene.radiance().begin(), scene.radiance().end());
    EXPECT_TRUE(scene.bounces().bounced().empty());
    scene.bounce({.albedo = albedo});
    const std::vector<glm::vec3> all(scene.radiance().begin(), scene.radiance().end());
    for (std::size_t i = 0; i < all.size(); ++i)
        ASSERT_EQ(all[i], direct[i] + scene.bounces().bounced()[i]);
    EXPECT_GT(std::accumulate(all.begin(), all.end(), glm::vec3(0.0f)).g,
              1.01f * std::accumulate(direct.begin(), direct.end(), glm::vec3(0.0f)).g);
    scene.light(white);
    EXPECT_TRUE(std::equal(direct.begin(), direct.end(), scene.radiance().begin()));
    // The bounces of this light are there already.
    EXPECT_EQ(scene.bounce({.albedo = albedo}).seconds, 0.0);
    EXPECT_TRUE(std::equal(all.begin(), all.end(), scene.radiance().begin()));
    EXPECT_GT(scene.bounce({.albedo = std::vector(albedo.size(), glm::vec3(0.4f))}).seconds, 0.0);
    EXPECT_GT(scene.bounce({.albedo = albedo}).seconds, 0.0);

    const Verification check = verify(scene, {.num_samples = 500, .num_paths = 64});
    EXPECT_GT(check.noise, 0.0);
    EXPECT_LT(check.error.relative_l2, 0.1);
    LitScene without(boulder_scene());
    without.light(white);
    EXPECT_THROW(without.bounce({.albedo = albedo}), std::invalid_argument);
}

TEST(LitScene, KnowsWhatLightsIt) {
    LitScene scene(boulder_scene());
    scene.light(scenes::smooth_environment(16));
    const std::array<std::uint32_t, 1> receiver = {
        nearest_receiver(scene.scene(), {0.0f, 10.0f, 0.0f})};
    const glm::dvec3 power = cubemap::total_power(contribution_map(scene, receiver));
    EXPECT_NEAR(power.g, static_cast<double>(scene.radiance()[receiver[0]].g), 1e-3 * power.g);

    // Two half spheres together are all of the light.
    const Share above =
        lit_by(scene, cubemap::Disc{.direction = {0, 1, 0}, .radius_degrees = 90.0});
    const Share below =
        lit_by(scene, cubemap::Disc{.direction = {0, -1, 0}, .radius_degrees = 90.0});
    EXPECT_GT(above.share, below.share);
    EXPECT_NEAR(above.share + below.share, 1.0, 1e-3);
    EXPECT_EQ(above.radiance.size(), scene.radiance().size());
    EXPECT_THROW(static_cast<void>(lit_by(scene, cubemap::Disc{.radius_degrees = -1.0})),
                 std::invalid_argument);
}

TEST(LitScene, ASunsPartIsDrawnAsSharpAsTheSun) {
    cubemap::CubeMap sun(256);
    sun.at(cubemap::Face::PositiveY, 100, 90) = glm::vec3(1e5f);
    LitScene scene(boulder_scene());
    scene.light(sun);
    const Share above =
        lit_by(scene, cubemap::Disc{.direction = {0, 1, 0}, .radius_degrees = 90.0});
    ASSERT_FALSE(above.lights.empty());
    Painter painter(scene, {.width = 40, .height = 30});
    const Picture whole = painter.draw(scene.lighting());
    EXPECT_EQ(painter.draw(above.lighting()).pixels, whole.pixels);
    // The vertices alone give a softer shadow.
    EXPECT_NE(painter.draw({.radiance = above.radiance, .environment = &above.environment}).pixels,
              whole.pixels);
}

} // namespace
} // namespace relumine
