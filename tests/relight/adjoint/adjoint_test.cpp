#include "relight/adjoint/adjoint.h"

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "files/parallel.h"
#include "tests/prt/scenes.h"
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
using scenes::smooth_environment;

/// <T e, w> against <e, T* w>, relative.
void expect_transposed(const Relighter& relighter, std::span<const glm::vec3> radiance,
                       const SurfaceBounces* bounces, std::uint32_t seed) {
    const std::vector<glm::vec3> weights = random_weights(radiance.size(), seed);
    const double forward = inner(radiance, weights);
    const double backward =
        inner(relighter.environment().texels, adjoint(relighter, weights, bounces).texels);
    EXPECT_NEAR(backward, forward, 1e-5 * std::abs(forward)) << "seed " << seed;
}

/// The scene with surfaces of all colours.
prt::Transfer colored_transfer() {
    prt::Transfer transfer = relit_scene().transfer;
    std::mt19937 random(5);
    std::uniform_real_distribution<float> albedo(0.0f, 1.0f);
    for (std::size_t i = 0; i < transfer.num_receivers(); ++i)
        transfer.surfaces.push_back({.albedo = {albedo(random), albedo(random), albedo(random)}});
    return transfer;
}

TEST(Adjoint, IsTheTransposeForRandomLightAndWeights) {
    const prt::Transfer colored = colored_transfer();
    Relighter through_clusters(relit_scene().transfer), of_surfaces(colored);
    for (std::uint32_t seed = 0; seed < 100; ++seed) {
        Relighter& relighter = seed % 2 == 0 ? through_clusters : of_surfaces;
        // Resolutions that fit the cells, do not fit them, and are coarser than they are.
        const std::uint32_t resolution = std::array{64u, 7u, 32u, 1u, 16u}[seed % 5];
        relighter.set_environment(random_environment(resolution, seed));
        expect_transposed(relighter, relighter.radiance(), nullptr, seed);
    }
}

TEST(Adjoint, IsTheTransposeWithTracedLights) {
    Relighter relighter(relit_scene().transfer, relit_scene().shadow_rays());
    for (std::uint32_t seed = 0; seed < 10; ++seed) {
        cubemap::CubeMap environment = random_environment(32, seed, 1.0f);
        environment.at(cubemap::Face::PositiveY, 11 + seed, 17) = glm::vec3(3e4f, 2e4f, 9e3f);
        environment.at(cubemap::Face::PositiveX, 20, 3 + seed) = glm::vec3(1e4f, 0.0f, 2e4f);
        relighter.set_environment(environment);
        ASSERT_FALSE(relighter.sharp_lights().empty());
        expect_transposed(relighter, relighter.radiance(), nullptr, seed);
        // After an update of a part, too.
        const std::vector<glm::vec3> lamp(64, glm::vec3(4.0f, 3.0f, 1.0f));
        update_region(relighter, {cubemap::Face::PositiveZ, 8, 8, 16, 16}, lamp);
        expect_transposed(relighter, relighter.radiance(), nullptr, seed);
    }
}

TEST(Adjoint, IsTheTransposeWithBounces) {
    const BouncingScene scene(scenes::sphere_and_box_on_floor(), 0.05f, 0.05f);
    std::vector<glm::vec3> albedo(scene.receivers.size(), glm::vec3(0.8f, 0.5f, 0.3f));
    Relighter relighter(scene.transfer);
    BounceLight light(scene.matrix, scene.transfer);
    light.set_albedo(albedo);
    for (const BounceLimits& limits :
         {BounceLimits{.num_bounces = 1}, BounceLimits{.num_bounces = 3},
          BounceLimits{.num_bounces = {}, .tolerance = 1e-7}}) {
        const SurfaceBounces bounces{.matrix = &scene.matrix, .albedo = albedo, .limits = limits};
        for (std::uint32_t seed = 0; seed < 34; ++seed) {
            relighter.set_environment(random_environment(16, seed));
            light.solve(relighter.radiance(), limits);
            std::vector<glm::vec3> radiance(relighter.radiance().begin(),
                                            relighter.radiance().end());
            for (std::size_t i = 0; i < radiance.size(); ++i)
                radiance[i] += light.indirect()[i];
            expect_transposed(relighter, radiance, &bounces, seed);
        }
    }
}

TEST(Adjoint, IsTheTransposeWithLightThatIsPassedOn) {
    const BouncingScene scene(scenes::sphere_and_box_on_floor(), 0.05f, 0.05f);
    const std::vector<glm::vec3> albedo(scene.receivers.size(), glm::vec3(0.4f, 0.2f, 0.3f));
    // Any two receivers may be sides of one surface here.
    std::vector<PassedOn> passed_on;
    const auto n = static_cast<std::uint32_t>(scene.receivers.size());
    for (std::uint32_t i = 0; i + 1 < n; i += 2) {
        passed_on.push_back({i, i + 1, glm::vec3(0.3f, 0.1f, 0.5f)});
        passed_on.push_back({i + 1, i, glm::vec3(0.2f, 0.4f, 0.0f)});
    }
    Relighter relighter(scene.transfer);
    BounceLight light(scene.matrix, scene.transfer);
    light.set_albedo(albedo, passed_on);
    for (const BounceLimits& limits :
         {BounceLimits{.num_bounces = 1}, BounceLimits{.num_bounces = 3},
          BounceLimits{.num_bounces = {}, .tolerance = 1e-7}}) {
        const SurfaceBounces bounces{
            .matrix = &scene.matrix, .albedo = albedo, .passed_on = passed_on, .limits = limits};
        for (std::uint32_t seed = 0; seed < 5; ++seed) {
            relighter.set_environment(random_environment(16, seed));
            light.solve(relighter.radiance(), limits);
            std::vector<glm::vec3> radiance(relighter.radiance().begin(),
                                            relighter.radiance().end());
            for (std::size_t i = 0; i < radiance.size(); ++i)
                radiance[i] += light.indirect()[i];
            expect_transposed(relighter, radiance, &bounces, seed);
        }
    }
}

/// Texels times a step are added to an environment and taken from it; half of the difference of
/// radiance is what the derivative says.
void expect_derivative(Relighter& relighter, const cubemap::CubeMap& environment,
                       const cubemap::CubeMap& step, double tolerance) {
    const std::vector<glm::vec3> weights(relighter.radiance().size(), glm::vec3(1.0f, 2.0f, 0.5f));
    relighter.set_environment(environment);
    const double expected = inner(step.texels, adjoint(relighter, weights).texels);
    std::array<double, 2> losses{};
    for (const std::size_t side : {0u, 1u}) {
        cubemap::CubeMap moved = environment;
        for (std::size_t i = 0; i < moved.texels.size(); ++i)
            moved.texels[i] += (side == 0 ? 1.0f : -1.0f) * step.texels[i];
        relighter.set_environment(moved);
        losses[side] = inner(relighter.radiance(), weights);
    }
    EXPECT_NEAR(0.5 * (losses[0] - losses[1]), expected, tolerance * std::abs(expected));
}

TEST(Adjoint, IsTheDerivativeOfTheRadiance) {
    Relighter relighter(relit_scene().transfer);
    const cubemap::CubeMap smooth = smooth_environment(32);
    for (std::uint32_t seed = 0; seed < 5; ++seed) {
        // One texel, whose place within its cluster matters; a coloured one turns the light.
        cubemap::CubeMap step(32);
        step.at(cubemap::AllFaces[seed], 5 + 3 * seed, 22 - 4 * seed) = {0.02f, 0.05f, 0.01f};
        expect_derivative(relighter, smooth, step, 2e-3);
        // All texels.
        step = random_environment(32, seed, 1.0f);
        for (glm::vec3& texel : step.texels)
            texel *= 0.05f;
        expect_derivative(relighter, smooth, step, 1e-4);
    }
}

TEST(Adjoint, OfDarknessIsWhatNewLightWouldGive) {
    Relighter relighter(relit_scene().transfer);
    relighter.set_environment(cubemap::CubeMap(64));
    const std::vector<glm::vec3> weights(relighter.radiance().size(), glm::vec3(1.0f));
    const cubemap::CubeMap derivative = adjoint(relighter, weights);
    cubemap::CubeMap light = smooth_environment(64);
    const double expected = inner(light.texels, derivative.texels);
    relighter.set_environment(light);
    // Clusters across a horizon may have their gate elsewhere.
    EXPECT_NEAR(inner(relighter.radiance(), weights), expected, 2e-3 * expected);
}

TEST(Adjoint, IsTheSameForAnyNumberOfThreads) {
    Relighter relighter(relit_scene().transfer, relit_scene().shadow_rays());
    cubemap::CubeMap environment = random_environment(32, 3);
    environment.at(cubemap::Face::PositiveY, 11, 17) = glm::vec3(3e4f);
    relighter.set_environment(environment);
    const std::vector<glm::vec3> weights = random_weights(relighter.radiance().size(), 9);
    const cubemap::CubeMap expected = adjoint(relighter, weights);
    for (const std::size_t num_threads : {1u, 2u, 3u, 8u}) {
        const files::ThreadLimit limit(num_threads);
        EXPECT_EQ(adjoint(relighter, weights).texels, expected.texels);
    }
}

TEST(Adjoint, RefusesWrongWeightsAndNoEnvironment) {
    Relighter relighter(relit_scene().transfer);
    std::vector<glm::vec3> weights(relighter.radiance().size(), glm::vec3(1.0f));
    EXPECT_THROW(static_cast<void>(adjoint(relighter, weights)), std::invalid_argument);
    relighter.set_environment(cubemap::CubeMap(4, glm::vec3(1.0f)));
    EXPECT_NO_THROW(static_cast<void>(adjoint(relighter, weights)));
    weights[7].g = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(static_cast<void>(adjoint(relighter, weights)), std::invalid_argument);
    weights.pop_back();
    EXPECT_THROW(static_cast<void>(adjoint(relighter, weights)), std::invalid_argument);
}

} // namespace
} // namespace relumine::relight
