#include "relumine/in/scene.h"

#include <cmath>

#include "mesh/floor.h"
#include "prt/tolerance.h"
#include "prt/visibility/ray_scene.h"
#include "tests/relumine/small_scenes.h"

namespace relumine {
namespace {

TEST(Tolerance, OfThePapersFormGrowsWithTheRootOfTheReceivers) {
    EXPECT_EQ(prt::rms_tolerance(0.03f, {}, 10'000), 0.03f);
    EXPECT_FLOAT_EQ(prt::rms_tolerance(0.03f, 5e-5f, 10'000), 5e-3f);
    // The default tolerance is the paper's epsilon for its Bunny.
    EXPECT_NEAR(prt::rms_tolerance(0.0f, 5e-5f, 73'196), prt::PrecomputeOptions{}.tolerance, 5e-5f);
}

TEST(Tolerance, TravelsWithTheScene) {
    const Scene rms = precompute(scenes::boulder(), {.tolerance = 0.07f});
    EXPECT_EQ(rms_tolerance(rms), 0.07f);
    const Scene papers = precompute(scenes::boulder(), {.epsilon = 3e-3f});
    EXPECT_EQ(rms_tolerance(papers),
              3e-3f * std::sqrt(static_cast<float>(papers.transfer.num_receivers())));
}

TEST(UnclusteredScene, HasVerticesAndABias) {
    const Scene scene = unclustered_scene(scenes::boulder());
    EXPECT_EQ(scene.receivers.positions, prt::vertex_receivers(scene.mesh).positions);
    EXPECT_EQ(scene.settings.bias, prt::automatic_bias(scene.mesh));
    EXPECT_EQ(scene.transfer.num_receivers(), 0u);
}

TEST(SetColors, ReachesTheTransfer) {
    Scene scene =
        precompute(scenes::boulder(), {.tolerance = scenes::Tolerance,
                                       .surface = everywhere({.albedo = glm::vec3(0.5f)})});
    set_colors(scene, {.albedo = glm::vec3(0.25f)});
    for (const prt::Surface& surface : scene.transfer.surfaces)
        EXPECT_EQ(surface.albedo, glm::vec3(0.25f));
    Scene plain = precompute(scenes::boulder(), {.tolerance = scenes::Tolerance});
    EXPECT_THROW(set_colors(plain, {.albedo = glm::vec3(0.25f)}), std::invalid_argument);
}

TEST(SetColors, LeavesTheFloorAlone) {
    Mesh mesh = scenes::boulder();
    mesh::append_floor(mesh.geometry, 4);
    mesh.floor_vertices = 4;
    Scene scene = precompute(std::move(mesh), {.tolerance = scenes::Tolerance,
                                               .surface = everywhere({.albedo = glm::vec3(0.5f)})});
    const std::size_t first = scene.mesh.num_vertices() - 16;
    EXPECT_EQ(first_floor_vertex(scene), first);
    set_colors(scene, {.albedo = glm::vec3(0.25f)});
    for (std::size_t i = 0; i < scene.mesh.num_vertices(); ++i)
        EXPECT_EQ(scene.receivers.surfaces[i].albedo, glm::vec3(i < first ? 0.25f : 1.0f));
}

TEST(FloorReceivers, AreThoseOfTheAddedFloor) {
    Mesh mesh(scenes::two_squares());
    mesh::append_floor(mesh.geometry, 3);
    mesh.floor_vertices = 3;
    const Scene scene = precompute(std::move(mesh), {.tolerance = 0.2f, .no_refine = true});
    const std::vector<bool> is_floor = floor_receivers(scene);
    ASSERT_EQ(is_floor.size(), 17u);
    for (std::size_t i = 0; i < 17; ++i)
        EXPECT_EQ(is_floor[i], i >= 8);
    EXPECT_TRUE(floor_receivers(unclustered_scene(scenes::two_squares())).empty());
    Scene damaged = scene;
    damaged.settings.floor_vertices = 5;
    EXPECT_FALSE(first_floor_vertex(damaged));
}

TEST(CameraOf, IsTheViewThatHighlightsAreFor) {
    const Camera camera{.eye = {3, 2, 1}, .target = {0, 0, 0}};
    const Scene seen = precompute(scenes::boulder(),
                                  {.tolerance = scenes::Tolerance, .view = View{.camera = camera}});
    EXPECT_EQ(camera_of(seen), camera);
    const Scene scene = precompute(scenes::boulder(), {.tolerance = scenes::Tolerance});
    EXPECT_EQ(camera_of(scene, 2.0f), relight::framed(scene.mesh, {.aspect = 2.0f}));
}

TEST(NearestReceiver, IsFound) {
    const Scene scene = unclustered_scene(scenes::two_squares());
    EXPECT_EQ(nearest_receiver(scene, {0.95f, 0.1f, -1.2f}), 2u);
    EXPECT_EQ(nearest_receiver(scene, {0.0f, 0.6f, 0.0f}), 4u);
}

} // namespace
} // namespace relumine
