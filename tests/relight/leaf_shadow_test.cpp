// The shadow of a card of leaves, which alpha cuts out.
#include <numeric>

#include <gtest/gtest.h>

#include "prt/precompute.h"
#include "prt/receivers/receivers.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "relight/reference/exact.h"
#include "relight/relighter.h"
#include "tests/prt/leaf_card.h"
#include "tests/prt/scenes.h"
#include "tests/relight/environments.h"

namespace relumine::relight {
namespace {

TEST(LeafShadow, IsThatOfExactIntegration) {
    const mesh::TriangleMesh mesh =
        scenes::with_card(scenes::floor_grid(9, 3.0f), scenes::leaf_card(16, 2.0f, 0.5f));
    prt::Receivers receivers = prt::vertex_receivers(mesh);
    receivers.normals.resize(9 * 9); // of the floor alone
    receivers.positions.resize(9 * 9);
    const prt::RayScene rays(mesh);
    const float bias = prt::automatic_bias(mesh);
    const prt::Transfer transfer = prt::precompute(receivers, prt::BeamScene(mesh, rays),
                                                   {.face_resolution = 64, .bias = bias});
    const cubemap::CubeMap environment = scenes::smooth_environment(64);
    Relighter relighter(transfer);
    relighter.set_environment(environment);
    std::vector<std::uint32_t> all(receivers.size());
    std::iota(all.begin(), all.end(), 0u);
    const auto exact = exact_radiance(receivers, all, rays, environment, {.bias = bias});
    const ErrorReport error = compare(all, exact, relighter.radiance());
    EXPECT_LT(error.relative_l2, 0.01);
    EXPECT_LT(error.max_abs, 0.03);
    // The light in the middle is what the leaves leave of the card's light: discs cover pi 0.4^2.
    const std::size_t middle = 4 * 9 + 4;
    const std::vector<glm::vec3> opaque = [&] {
        mesh::TriangleMesh card = mesh;
        card.triangle_materials.clear();
        const prt::RayScene solid(card);
        return std::vector<glm::vec3>{glm::vec3(exact_radiance(
            receivers, std::vector{std::uint32_t{middle}}, solid, environment, {.bias = bias})[0])};
    }();
    const double open =
        exact_radiance(receivers, std::vector{std::uint32_t{middle}},
                       prt::RayScene(scenes::floor_grid(9, 3.0f)), environment, {.bias = bias})[0]
            .g;
    const double covered = std::numbers::pi * scenes::LeafRadius * scenes::LeafRadius;
    const double expected = covered * static_cast<double>(opaque[0].g) + (1.0 - covered) * open;
    EXPECT_NEAR(exact[middle].g, expected, 0.02 * open);
}

} // namespace
} // namespace relumine::relight
