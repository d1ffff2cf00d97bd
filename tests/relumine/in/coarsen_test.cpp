#include "relumine/in/coarsen.h"

#include <gtest/gtest.h>

#include "data_gen/environments.h"
#include "mesh/floor.h"
#include "relumine/ask/questions.h"
#include "tests/relumine/small_scenes.h"

namespace relumine {
namespace {

constexpr float Fine = 0.02f, Coarse = 0.06f;

Scene made_with(float tolerance) {
    Mesh mesh = scenes::boulder();
    mesh.floor_vertices = 24;
    mesh::append_floor(mesh.geometry, mesh.floor_vertices);
    return precompute(std::move(mesh), {.tolerance = tolerance, .face_resolution = 128});
}

/// Against exact integration
double error_under(const Scene& scene, const cubemap::CubeMap& map) {
    LitScene lit{Scene(scene)};
    lit.light(map);
    return verify(lit, {.num_samples = 200, .num_surface_points = 0}).error.relative_l2;
}

TEST(Coarsened, IsAsPreciseAsAFreshScene) {
    const Scene fresh = made_with(Coarse);
    const Scene coarse = coarsened(made_with(Fine), Coarse);
    EXPECT_EQ(rms_tolerance(coarse), Coarse);
    for (const data_gen::Environment& environment : data_gen::environments()) {
        const cubemap::CubeMap map = environment.make(32);
        EXPECT_LE(error_under(coarse, map), 1.5 * error_under(fresh, map) + 1e-3)
            << environment.name;
    }
}

TEST(Coarsened, KeepsAllButTheClusters) {
    const Scene fine = made_with(Fine);
    const Scene coarse = coarsened(fine, Coarse);
    EXPECT_LT(coarse.transfer.num_clusters(), fine.transfer.num_clusters() / 2);
    EXPECT_EQ(coarse.transfer.order, fine.transfer.order);
    EXPECT_EQ(coarse.receivers.positions, fine.receivers.positions);
    EXPECT_EQ(coarse.mesh.triangles, fine.mesh.triangles);
    EXPECT_EQ(coarse.settings.bias, fine.settings.bias);
}

TEST(Coarsened, ChangesNothingAtTheScenesOwnToleranceAndRefusesLess) {
    const Scene fine = made_with(Coarse);
    const Scene same = coarsened(fine, Coarse);
    EXPECT_EQ(same.transfer.counts.counts, fine.transfer.counts.counts);
    EXPECT_EQ(same.transfer.counts.visible, fine.transfer.counts.visible);
    EXPECT_THROW(static_cast<void>(coarsened(fine, Fine)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(coarsened(unclustered_scene(scenes::boulder()), Coarse)),
                 std::invalid_argument);
}

} // namespace
} // namespace relumine
