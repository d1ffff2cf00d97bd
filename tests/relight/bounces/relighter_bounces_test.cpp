// Bounces of a Relighter and a LightEditor: edits, steps, undo, and what lights what.
#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cubemap/layers/light_layer.h"
#include "relight/contribution.h"
#include "relight/light_editor.h"
#include "relight/relighter.h"
#include "tests/prt/scenes.h"
#include "tests/relight/bounces/bouncing_scene.h"

namespace relumine::relight {
namespace {

using Colors = std::vector<glm::vec3>;

Colors copy(std::span<const glm::vec3> values) {
    return {values.begin(), values.end()};
}

double relative_difference(std::span<const glm::vec3> a, std::span<const glm::vec3> b) {
    double difference = 0.0, all = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const glm::dvec3 d = glm::dvec3(a[i]) - glm::dvec3(b[i]);
        difference += glm::dot(d, d);
        all += glm::dot(glm::dvec3(b[i]), glm::dvec3(b[i]));
    }
    return std::sqrt(difference / all);
}

class RelighterBounces : public testing::Test {
protected:
    static void SetUpTestSuite() {
        bouncing = new BouncingScene(scenes::sphere_and_box_on_floor(), 0.02f, 0.05f);
    }
    static void TearDownTestSuite() { delete bouncing; }

    static ShadowRays rays() {
        return {.blockers = &bouncing->rays,
                .positions = bouncing->receivers.positions,
                .bias = bouncing->bias,
                .tolerance = 0.05f};
    }
    static SurfaceBounces bounces(const BounceLimits& limits = {}) {
        Colors albedo;
        for (std::size_t i = 0; i < bouncing->receivers.size(); ++i)
            albedo.emplace_back(0.8f, 0.5f, i % 2 == 0 ? 0.7f : 0.1f);
        return {.matrix = &bouncing->matrix, .albedo = albedo, .limits = limits};
    }
    /// A dim sky with a small sun, which has shadow rays of its own.
    static cubemap::CubeMap sunny(float sun = 3000.0f) {
        cubemap::CubeMap map(32, glm::vec3(0.3f, 0.4f, 0.6f));
        map.at(cubemap::Face::PositiveY, 20, 12) = glm::vec3(sun);
        return map;
    }
    static cubemap::LightLayer lamp(float radiance) {
        cubemap::LightLayer layer;
        layer.name = "lamp";
        layer.region = cubemap::Disc{.direction = {1.0, 0.5, 0.2}, .radius_degrees = 15.0};
        layer.effect = cubemap::Emit{.radiance = glm::vec3(radiance)};
        return layer;
    }
    static BouncingScene* bouncing;
};
BouncingScene* RelighterBounces::bouncing = nullptr;

TEST_F(RelighterBounces, ArePartOfTheRadianceUntilTheLightIsReplaced) {
    Relighter relighter(bouncing->transfer, rays());
    EXPECT_THROW(relighter.bounce(), std::logic_error);
    relighter.set_environment(sunny());
    const Colors direct = copy(relighter.radiance());
    EXPECT_TRUE(relighter.is_settled()) << "nothing bounces";
    relighter.set_bounces(bounces());
    EXPECT_FALSE(relighter.is_settled());
    EXPECT_EQ(copy(relighter.radiance()), direct);
    relighter.bounce();
    EXPECT_TRUE(relighter.is_settled());
    const Colors all = copy(relighter.radiance());
    const Colors soft = relighter.soft_radiance();
    for (std::size_t i = 0; i < all.size(); ++i) {
        ASSERT_EQ(all[i], direct[i] + relighter.bounced()[i]);
        ASSERT_LE(relighter.bounced()[i].g, soft[i].g);
    }
    EXPECT_GT(relative_difference(all, direct), 0.02);
    EXPECT_EQ(copy(relighter.diffuse_radiance()), direct);
    relighter.set_environment(sunny());
    EXPECT_EQ(copy(relighter.radiance()), direct);
    relighter.bounce();
    EXPECT_EQ(copy(relighter.radiance()), all);
    relighter.set_bounces({});
    EXPECT_EQ(copy(relighter.radiance()), direct);
}

TEST_F(RelighterBounces, AnUpdateShowsItsDirectLightAtOnceAndStepsBringTheRest) {
    Relighter fresh(bouncing->transfer, rays());
    fresh.set_environment(sunny(9000.0f));
    fresh.set_bounces(bounces());
    fresh.bounce();
    Relighter relighter(bouncing->transfer, rays());
    relighter.set_environment(sunny());
    relighter.set_bounces(bounces());
    relighter.bounce();
    const Colors bounced = copy(relighter.bounced());
    const glm::vec3 sun(9000.0f);
    update_region(relighter, 
        {.face = cubemap::Face::PositiveY, .x0 = 20, .y0 = 12, .x1 = 21, .y1 = 13}, {&sun, 1});
    EXPECT_EQ(copy(relighter.bounced()), bounced);
    EXPECT_LT(relative_difference(relighter.diffuse_radiance(), fresh.diffuse_radiance()), 1e-5);
    for (std::size_t i = 0; i < bounced.size(); ++i)
        ASSERT_EQ(relighter.radiance()[i], relighter.diffuse_radiance()[i] + bounced[i]);
    EXPECT_FALSE(relighter.is_settled());
    int num_steps = 0;
    double error = 1.0;
    while (!relighter.is_settled() && num_steps < 30) {
        relighter.step();
        const double now = relative_difference(relighter.radiance(), fresh.radiance());
        EXPECT_LT(now, error + 1e-3);
        error = now;
        ++num_steps;
    }
    EXPECT_GE(num_steps, 2);
    EXPECT_LT(num_steps, 15);
    EXPECT_LT(error, 2e-3) << "the tolerance of all bounces is 1e-3";
    relighter.bounce();
    EXPECT_LT(relative_difference(relighter.radiance(), fresh.radiance()), 1e-5);
}

TEST_F(RelighterBounces, OfSeveralLightsAreTheSumOfTheirs) {
    const BounceLimits three{.num_bounces = 3};
    Relighter one(bouncing->transfer, rays()), other(bouncing->transfer, rays());
    one.set_environment(sunny());
    other.set_environment(cubemap::CubeMap(8, glm::vec3(0.5f, 0.1f, 0.2f)));
    for (Relighter* relighter : {&one, &other}) {
        relighter->set_bounces(bounces(three));
        relighter->bounce();
    }
    Colors sum = copy(one.bounced());
    for (std::size_t i = 0; i < sum.size(); ++i)
        sum[i] += other.bounced()[i];
    one.bounce(other.diffuse_radiance());
    EXPECT_LT(relative_difference(one.bounced(), sum), 1e-5);
    EXPECT_THROW(one.bounce(Colors(3)), std::invalid_argument);
}

TEST_F(RelighterBounces, AnEditAndItsReverseLeaveNothingAndUndoIsBitwise) {
    LightEditor editor(bouncing->transfer, rays());
    editor.set_base(sunny());
    editor.set_bounces(bounces());
    editor.forget_history();
    EXPECT_TRUE(editor.is_settled());
    const Colors before = copy(editor.radiance());
    editor.set_layers({lamp(20.0f)});
    EXPECT_FALSE(editor.is_settled());
    editor.settle();
    EXPECT_GT(relative_difference(editor.radiance(), before), 0.1);
    editor.set_layers({});
    editor.settle();
    EXPECT_LT(relative_difference(editor.radiance(), before), 1e-5);
    editor.forget_history();
    EXPECT_EQ(copy(editor.radiance()), before);

    editor.set_layers({lamp(20.0f)});
    editor.step();
    editor.mark();
    const Colors marked = copy(editor.radiance());
    editor.set_layers({lamp(50.0f)});
    editor.step();
    editor.mark();
    editor.undo();
    EXPECT_EQ(copy(editor.radiance()), marked);
    editor.undo();
    EXPECT_EQ(copy(editor.radiance()), before);
    editor.redo();
    EXPECT_EQ(copy(editor.radiance()), marked);
    Colors seen;
    editor.snapshot(seen);
    EXPECT_EQ(seen, marked);
    // Another base, too, comes back with its bounces.
    editor.set_base(cubemap::CubeMap(16, glm::vec3(0.7f)));
    editor.mark();
    editor.undo();
    EXPECT_EQ(copy(editor.radiance()), marked);
}

TEST_F(RelighterBounces, FactorsAreTheTransposeOfTheBounces) {
    const SurfaceBounces all = bounces({.num_bounces = 4});
    Relighter relighter(bouncing->transfer, rays());
    relighter.set_environment(sunny());
    relighter.set_bounces(all);
    relighter.bounce();
    const auto num_receivers = static_cast<std::uint32_t>(bouncing->receivers.size());
    const std::vector<std::uint32_t> receivers = {5, num_receivers / 2, num_receivers - 1};
    const auto factors = bounce_factors(all, bouncing->transfer, receivers);
    glm::dvec3 sum(0.0), expected(0.0);
    for (std::size_t i = 0; i < factors.size(); ++i)
        sum += factors[i] * glm::dvec3(relighter.diffuse_radiance()[i]);
    for (const std::uint32_t receiver : receivers)
        expected += glm::dvec3(relighter.bounced()[receiver]) / 3.0;
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(sum[c], expected[c], 1e-4 * expected[c]);
    EXPECT_THROW(static_cast<void>(bounce_factors(all, bouncing->transfer, {})),
                 std::invalid_argument);
    const std::uint32_t none = num_receivers;
    EXPECT_THROW(static_cast<void>(bounce_factors(all, bouncing->transfer, {&none, 1})),
                 std::invalid_argument);
}

TEST_F(RelighterBounces, AreInWhatLightsAReceiverAndInWhatARegionLights) {
    Relighter relighter(bouncing->transfer, rays());
    relighter.set_environment(sunny());
    // The darkest receiver has most of its light from others.
    relighter.set_bounces(bounces());
    relighter.bounce();
    std::uint32_t receiver = 0;
    for (std::uint32_t i = 0; i < bouncing->receivers.size(); ++i)
        if (relighter.bounced()[i].g > relighter.bounced()[receiver].g)
            receiver = i;
    const glm::dvec3 power = cubemap::total_power(contribution_map(relighter, {&receiver, 1}));
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(power[c], static_cast<double>(relighter.radiance()[receiver][c]),
                    2e-3 * power[c]);

    const std::size_t num_texels = relighter.environment().texels.size();
    EXPECT_EQ(copy(relit_by_part(relighter, std::vector(num_texels, 1.0f)).radiance()),
              copy(relighter.radiance()));
    std::vector<float> some(num_texels), rest(num_texels);
    for (std::size_t i = 0; i < num_texels; ++i) {
        some[i] = i % 3 == 0 ? 1.0f : 0.25f;
        rest[i] = 1.0f - some[i];
    }
    Colors sum = copy(relit_by_part(relighter, some).radiance());
    const Colors other = copy(relit_by_part(relighter, rest).radiance());
    for (std::size_t i = 0; i < sum.size(); ++i)
        sum[i] += other[i];
    EXPECT_LT(relative_difference(sum, relighter.radiance()), 2e-3);
}

} // namespace
} // namespace relumine::relight
