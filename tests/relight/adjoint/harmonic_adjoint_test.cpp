#include "relight/adjoint/harmonic_adjoint.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "files/parallel.h"
#include "tests/relight/adjoint/inner_products.h"
#include "tests/relight/bounces/bouncing_scene.h"
#include "tests/relight/environments.h"
#include "tests/relight/relit_scene.h"

namespace relumine::relight {
namespace {

using scenes::inner;
using scenes::random_environment;
using scenes::random_weights;
using scenes::relit_scene;

/// <T e, w> against <e, T* w>, relative to what the products are summed from.
void expect_transposed_harmonics(const Relighter& relighter, std::span<const glm::vec3> light,
                                 const SurfaceBounces* bounces, std::uint32_t seed) {
    const std::vector<glm::vec3> weights = random_weights(light.size(), seed);
    const double forward = inner(light, weights);
    const double backward = inner(relighter.environment().texels,
                                  harmonics_adjoint(relighter, weights, bounces).texels);
    EXPECT_NEAR(backward, forward, 1e-5 * std::abs(forward)) << "seed " << seed;
}

prt::Transfer points_of_scene() {
    prt::Receivers points;
    points.have_no_surface = true;
    std::mt19937 random(7);
    std::uniform_real_distribution<float> place(-3.0f, 3.0f), height(0.2f, 3.0f);
    for (int i = 0; i < 150; ++i)
        points.positions.push_back({place(random), height(random), place(random)});
    points.normals.resize(points.positions.size(), glm::vec3(0.0f));
    return prt::precompute(points, relit_scene().rays,
                           {.tolerance = 0.0135f, .min_level = 4, .face_resolution = 64});
}

TEST(HarmonicsAdjoint, IsTheTransposeForRandomLightAndWeights) {
    const prt::Transfer points = points_of_scene();
    for (const std::uint32_t order : {1u, 2u, 3u}) {
        Relighter on_surfaces(relit_scene().transfer, {}, order), in_space(points, {}, order);
        for (std::uint32_t seed = 0; seed < 20; ++seed)
            for (Relighter* relighter : {&on_surfaces, &in_space}) {
                const std::uint32_t resolution = std::array{64u, 7u, 32u, 1u, 16u}[seed % 5];
                relighter->set_environment(random_environment(resolution, seed));
                expect_transposed_harmonics(*relighter, relighter->harmonics(), nullptr, seed);
            }
    }
}

TEST(HarmonicsAdjoint, IsTheTransposeWithTracedLights) {
    Relighter relighter(relit_scene().transfer, relit_scene().shadow_rays(), 3);
    for (std::uint32_t seed = 0; seed < 10; ++seed) {
        cubemap::CubeMap environment = random_environment(32, seed, 1.0f);
        environment.at(cubemap::Face::PositiveY, 11 + seed, 17) = glm::vec3(3e4f, 2e4f, 9e3f);
        relighter.set_environment(environment);
        ASSERT_FALSE(relighter.sharp_lights().empty());
        expect_transposed_harmonics(relighter, relighter.harmonics(), nullptr, seed);
    }
}

TEST(HarmonicsAdjoint, IsTheTransposeWithBounces) {
    const BouncingScene scene(scenes::sphere_and_box_on_floor(), 0.05f, 0.05f);
    const std::vector<glm::vec3> albedo(scene.receivers.size(), glm::vec3(0.8f, 0.5f, 0.3f));
    Relighter relighter(scene.transfer, {}, 3);
    BounceLight light(scene.matrix, scene.transfer);
    light.set_albedo(albedo);
    const BounceLimits limits{.num_bounces = 3};
    const SurfaceBounces bounces{.matrix = &scene.matrix, .albedo = albedo, .limits = limits};
    for (std::uint32_t seed = 0; seed < 10; ++seed) {
        relighter.set_environment(random_environment(16, seed));
        light.solve(relighter.radiance(), limits);
        std::vector<glm::vec3> radiance(relighter.radiance().begin(), relighter.radiance().end());
        for (std::size_t i = 0; i < radiance.size(); ++i)
            radiance[i] += light.indirect()[i];
        std::vector<glm::vec3> harmonics = relighter.harmonics();
        bind_to(scene.transfer, radiance, harmonics);
        expect_transposed_harmonics(relighter, harmonics, &bounces, seed);
    }
}

/// Half of the difference under light that is a step more and a step less is what the derivative
/// says.
TEST(HarmonicsAdjoint, IsTheDerivativeOfTheCoefficients) {
    const prt::Transfer points = points_of_scene();
    Relighter on_surfaces(relit_scene().transfer, {}, 3), in_space(points, {}, 3);
    const cubemap::CubeMap smooth = scenes::smooth_environment(32);
    for (Relighter* relighter : {&on_surfaces, &in_space})
        for (std::uint32_t seed = 0; seed < 4; ++seed) {
            relighter->set_environment(smooth);
            const std::vector<glm::vec3> weights =
                random_weights(relighter->harmonics().size(), seed);
            cubemap::CubeMap step = random_environment(32, seed, 1.0f);
            if (seed % 2 == 0) { // One face alone.
                const std::size_t of_face = step.texels.size() / cubemap::NumFaces;
                for (std::size_t i = 0; i < step.texels.size(); ++i)
                    step.texels[i] *= i / of_face == seed ? 1.0f : 0.0f;
            }
            const double expected =
                0.1 * inner(step.texels, harmonics_adjoint(*relighter, weights).texels);
            std::array<double, 2> losses{};
            for (const std::size_t side : {0u, 1u}) {
                cubemap::CubeMap moved = smooth;
                for (std::size_t i = 0; i < moved.texels.size(); ++i)
                    moved.texels[i] += (side == 0 ? 0.05f : -0.05f) * step.texels[i];
                relighter->set_environment(moved);
                losses[side] = inner(relighter->harmonics(), weights);
            }
            EXPECT_NEAR(losses[0] - losses[1], expected, 2e-3 * std::abs(expected)) << seed;
        }
}

/// The first coefficient of points is their mean radiance.
TEST(HarmonicsAdjoint, OfPointsKnowsTheirRadiance) {
    const prt::Transfer points = points_of_scene();
    Relighter relighter(points);
    relighter.set_environment(random_environment(32, 4));
    const std::vector<glm::vec3> weights = random_weights(points.num_receivers(), 3);
    const double forward = inner(relighter.radiance(), weights);
    const double backward =
        inner(relighter.environment().texels, adjoint(relighter, weights).texels);
    EXPECT_NEAR(backward, forward, 1e-5 * std::abs(forward));

    // In the open, a texel counts by its solid angle, but for the flux of a cluster, which is told
    // from its vector: 2e-3.
    prt::Receivers alone;
    alone.have_no_surface = true;
    alone.positions = {glm::vec3(0.0f, 50.0f, 0.0f)};
    alone.normals = {glm::vec3(0.0f)};
    const scenes::RelitScene& scene = relit_scene();
    const prt::Transfer open = prt::precompute(
        alone, scene.rays, {.tolerance = 0.1f, .min_level = 4, .face_resolution = 64});
    Relighter above(open);
    above.set_environment(scenes::smooth_environment(16));
    const std::vector<glm::vec3> one(1, glm::vec3(1.0f));
    const cubemap::CubeMap derivative = adjoint(above, one);
    const std::vector<double> solid_angles = cubemap::texel_solid_angles(16);
    const std::size_t face = derivative.index(cubemap::Face::PositiveY, 0, 0);
    for (std::size_t i = 0; i < solid_angles.size(); i += 5) {
        const double expected = solid_angles[i] / (4.0 * std::numbers::pi);
        EXPECT_NEAR(derivative.texels[face + i].g, expected, 2e-3 * expected);
    }
}

TEST(HarmonicsAdjoint, IsTheSameForAnyNumberOfThreads) {
    Relighter relighter(relit_scene().transfer, {}, 3);
    relighter.set_environment(random_environment(32, 11));
    const std::vector<glm::vec3> weights = random_weights(relighter.harmonics().size(), 1);
    const cubemap::CubeMap expected = harmonics_adjoint(relighter, weights);
    for (const std::size_t threads : {1u, 3u, 8u}) {
        const files::ThreadLimit limit(threads);
        EXPECT_EQ(harmonics_adjoint(relighter, weights).texels, expected.texels);
    }
}

TEST(HarmonicsAdjoint, RefusesWhatItCannotDo) {
    Relighter relighter(relit_scene().transfer, {}, 3), without(relit_scene().transfer);
    const auto found = [](const Relighter& asked, std::size_t count, float value) {
        static_cast<void>(harmonics_adjoint(asked, std::vector(count, glm::vec3(value))));
    };
    const std::size_t count = 9 * relit_scene().transfer.num_receivers();
    EXPECT_THROW(found(relighter, count, 1.0f), std::invalid_argument); // dark
    relighter.set_environment(random_environment(8, 1));
    without.set_environment(random_environment(8, 1));
    EXPECT_THROW(found(relighter, count - 1, 1.0f), std::invalid_argument);
    EXPECT_THROW(found(relighter, count, std::numeric_limits<float>::infinity()),
                 std::invalid_argument);
    EXPECT_THROW(found(without, count, 1.0f), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(adjoint(relighter, std::vector(count, glm::vec3(1.0f)))),
                 std::invalid_argument);
    EXPECT_NO_THROW(found(relighter, count, 1.0f));
}

} // namespace
} // namespace relumine::relight
