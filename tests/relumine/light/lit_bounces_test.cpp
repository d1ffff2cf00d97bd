// Bounces of a lit scene: edits, steps, undo, and what lights what.

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "relumine/ask/questions.h"
#include "relumine/light/edits.h"
#include "relumine/light/lit_scene.h"
#include "relumine/out/output.h"
#include "tests/prt/scenes.h"
#include "tests/relight/arrays.h"
#include "tests/relumine/light/bouncing_lit_scene.h"
#include "tests/relumine/light/relit_lit_scene.h"

namespace relumine {
namespace {

using Colors = std::vector<glm::vec3>;

using relight::copy;
using scenes::relative_difference;

class LitBounces : public testing::Test {
protected:
    static void SetUpTestSuite() {
        scene = scenes::whole_bouncing_scene(
            relight::BouncingScene(scenes::sphere_and_box_on_floor(), 0.02f, 0.05f));
        for (std::size_t i = 0; i < scene->receivers.size(); ++i)
            albedo.emplace_back(0.8f, 0.5f, i % 2 == 0 ? 0.7f : 0.1f);
    }
    static void TearDownTestSuite() {
        scene.reset();
        albedo.clear();
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
    static std::shared_ptr<const Scene> scene;
    static Colors albedo;
};
std::shared_ptr<const Scene> LitBounces::scene;
Colors LitBounces::albedo;

TEST_F(LitBounces, ArePartOfTheRadianceUntilTheLightIsReplaced) {
    LitScene lit(scene);
    EXPECT_THROW(lit.bounce(), std::logic_error);
    EXPECT_THROW(lit.bounce({.albedo = albedo}), std::logic_error);
    lit.light(sunny());
    EXPECT_THROW(lit.bounce(), std::logic_error) << "no albedo";
    const Colors direct = copy(lit.radiance());
    EXPECT_TRUE(lit.bounces().is_settled()) << "nothing bounces";
    lit.bounce({.albedo = albedo});
    EXPECT_TRUE(lit.bounces().is_settled());
    const Colors all = copy(lit.radiance());
    const Colors bounced = copy(lit.bounces().bounced());
    const Colors soft = lit.lighting().soft;
    for (std::size_t i = 0; i < all.size(); ++i) {
        ASSERT_EQ(all[i], direct[i] + bounced[i]);
        ASSERT_LE(bounced[i].g, soft[i].g);
    }
    EXPECT_GT(relative_difference(all, direct), 0.02);
    EXPECT_EQ(copy(lit.relighter().diffuse_radiance()), direct);
    lit.light(sunny());
    EXPECT_FALSE(lit.bounces().is_settled());
    EXPECT_EQ(copy(lit.radiance()), direct);
    lit.bounce();
    EXPECT_EQ(copy(lit.radiance()), all);
}

TEST_F(LitBounces, AnUpdateShowsItsDirectLightAtOnceAndStepsBringTheRest) {
    LitScene fresh(scene);
    fresh.light(sunny(9000.0f));
    fresh.bounce({.albedo = albedo});
    LitScene lit(scene);
    lit.light(sunny());
    lit.bounce({.albedo = albedo});
    const Colors bounced = copy(lit.bounces().bounced());
    const glm::vec3 sun(9000.0f);
    lit.environment().update_region(
        {.face = cubemap::Face::PositiveY, .x0 = 20, .y0 = 12, .x1 = 21, .y1 = 13}, {&sun, 1});
    EXPECT_EQ(copy(lit.bounces().bounced()), bounced);
    const Colors direct = copy(lit.relighter().diffuse_radiance());
    EXPECT_LT(relative_difference(direct, fresh.relighter().diffuse_radiance()), 1e-5);
    for (std::size_t i = 0; i < bounced.size(); ++i)
        ASSERT_EQ(lit.radiance()[i], direct[i] + bounced[i]);
    EXPECT_FALSE(lit.bounces().is_settled());
    int num_steps = 0;
    double error = 1.0;
    while (!lit.bounces().is_settled() && num_steps < 30) {
        lit.bounce({.is_step = true});
        const double now = relative_difference(lit.radiance(), fresh.radiance());
        EXPECT_LT(now, error + 1e-3);
        error = now;
        ++num_steps;
    }
    EXPECT_GE(num_steps, 2);
    EXPECT_LT(num_steps, 15);
    EXPECT_LT(error, 2e-3) << "the tolerance of all bounces is 1e-3";
    lit.bounce();
    EXPECT_LT(relative_difference(lit.radiance(), fresh.radiance()), 1e-5);
}

TEST_F(LitBounces, OfSeveralLightsAreTheSumOfTheirs) {
    const Bouncing three{.albedo = albedo, .limits = {.num_bounces = 3}};
    const std::vector<lights::DistantLight> list = {
        {.direction = glm::dvec3(0.6, 0.8, 0), .irradiance = glm::dvec3(2.0, 1.0, 0.5)}};
    LitScene one(scene), other(scene), both(scene);
    one.light(sunny());
    other.light(list);
    Light sum(sunny());
    sum.lights = list;
    both.light(sum);
    for (LitScene* lit : {&one, &other, &both}) {
        const Colors direct = copy(lit->radiance());
        lit->bounce(three);
        for (std::size_t i = 0; i < direct.size(); i += 17)
            EXPECT_LT(glm::distance(lit->radiance()[i], direct[i] + lit->bounces().bounced()[i]),
                      1e-5f * glm::length(direct[i]) + 1e-6f);
    }
    const auto expect_sum = [&](std::span<const glm::vec3> a, std::span<const glm::vec3> b,
                                std::span<const glm::vec3> of_both) {
        ASSERT_EQ(a.size(), of_both.size());
        Colors values = copy(a);
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] += b[i];
        EXPECT_LT(relative_difference(values, of_both), 1e-5);
    };
    expect_sum(one.bounces().bounced(), other.bounces().bounced(), both.bounces().bounced());
    expect_sum(one.radiance(), other.radiance(), both.radiance());
    const Lighting a = one.lighting(), b = other.lighting(), of_both = both.lighting();
    EXPECT_EQ(of_both.lights.size(), a.lights.size() + b.lights.size());
    EXPECT_EQ(of_both.environment, &environment_of(both));
    expect_sum(a.soft, b.soft, of_both.soft);
}

TEST_F(LitBounces, AnEditAndItsReverseLeaveNothingAndUndoIsBitwise) {
    LitScene lit(scene);
    lit.light(sunny());
    lit.bounce({.albedo = albedo});
    forget_history(lit);
    EXPECT_TRUE(lit.bounces().is_settled());
    const Colors before = copy(lit.radiance());
    set_layers(lit, {lamp(20.0f)});
    EXPECT_FALSE(lit.bounces().is_settled());
    lit.bounce();
    EXPECT_GT(relative_difference(lit.radiance(), before), 0.1);
    set_layers(lit, {});
    lit.bounce();
    EXPECT_LT(relative_difference(lit.radiance(), before), 1e-5);
    forget_history(lit);
    EXPECT_EQ(copy(lit.radiance()), before);

    set_layers(lit, {lamp(20.0f)});
    lit.bounce({.is_step = true});
    mark(lit);
    const Colors marked = copy(lit.radiance());
    set_layers(lit, {lamp(50.0f)});
    lit.bounce({.is_step = true});
    mark(lit);
    undo(lit);
    EXPECT_EQ(copy(lit.radiance()), marked);
    undo(lit);
    EXPECT_EQ(copy(lit.radiance()), before);
    redo(lit);
    EXPECT_EQ(copy(lit.radiance()), marked);
    // Another base, too, comes back with its bounces.
    lit.light(cubemap::CubeMap(16, glm::vec3(0.7f)));
    mark(lit);
    undo(lit);
    EXPECT_EQ(copy(lit.radiance()), marked);
}

TEST_F(LitBounces, FactorsAreTheTransposeOfTheBounces) {
    LitScene lit(scene);
    lit.light(sunny());
    lit.bounce({.albedo = albedo, .limits = {.num_bounces = 4}});
    const relight::SurfaceBounces& all = lit.bounces().surfaces();
    const auto num_receivers = static_cast<std::uint32_t>(scene->receivers.size());
    const std::vector<std::uint32_t> receivers = {5, num_receivers / 2, num_receivers - 1};
    Colors weights(num_receivers, glm::vec3(0.0f));
    for (const std::uint32_t receiver : receivers)
        weights[receiver] = glm::vec3(1.0f / 3.0f);
    const auto factors = relight::bounce_adjoint(all, scene->transfer, weights);
    glm::dvec3 sum(0.0), expected(0.0);
    for (std::size_t i = 0; i < factors.size(); ++i)
        sum += glm::dvec3(factors[i]) * glm::dvec3(lit.relighter().diffuse_radiance()[i]);
    for (const std::uint32_t receiver : receivers)
        expected += glm::dvec3(lit.bounces().bounced()[receiver]) / 3.0;
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(sum[c], expected[c], 1e-4 * expected[c]);
    weights.pop_back();
    EXPECT_THROW(static_cast<void>(relight::bounce_adjoint(all, scene->transfer, weights)),
                 std::invalid_argument);
}

TEST_F(LitBounces, AreInWhatLightsAReceiverAndInWhatARegionLights) {
    LitScene lit(scene);
    lit.light(sunny());
    lit.bounce({.albedo = albedo});
    // The darkest receiver has most of its light from others.
    const std::span<const glm::vec3> bounced = lit.bounces().bounced();
    std::uint32_t receiver = 0;
    for (std::uint32_t i = 0; i < bounced.size(); ++i)
        if (bounced[i].g > bounced[receiver].g)
            receiver = i;
    const glm::dvec3 power = cubemap::total_power(contribution_map(lit, {&receiver, 1}));
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(power[c], static_cast<double>(lit.radiance()[receiver][c]), 2e-3 * power[c]);

    const cubemap::Disc all{.direction = {0, 1, 0}, .radius_degrees = 180.0};
    EXPECT_EQ(lit_by(lit, all).radiance, copy(lit.radiance()));
    Colors sum =
        lit_by(lit, cubemap::Disc{.direction = {0, 1, 0}, .radius_degrees = 90.0}).radiance;
    const Share other = lit_by(lit, cubemap::Disc{.direction = {0, -1, 0}, .radius_degrees = 90.0});
    for (std::size_t i = 0; i < sum.size(); ++i)
        sum[i] += other.radiance[i];
    EXPECT_LT(relative_difference(sum, lit.radiance()), 2e-3);
}

} // namespace
} // namespace relumine
