#include "viewer/light_desk.h"

#include <optional>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "relumine/in/precompute.h"
#include "tests/relumine/light/bouncing_lit_scene.h"
#include "tests/relumine/light/relit_lit_scene.h"
#include "viewer/gestures.h"

namespace relumine::viewer {
namespace {

Environment environment(cubemap::CubeMap map, const std::filesystem::path& path) {
    return {.map = std::move(map), .file = {}, .assumptions = {}, .path = path};
}

class LightDeskTest : public testing::Test {
protected:
    LightDeskTest() {
        lit_.light(cubemap::CubeMap(64, glm::vec3(0.1f)));
        desk_.emplace(lit_);
        hand_.emplace(*desk_);
    }

    [[nodiscard]] std::vector<glm::vec3> radiance() const {
        return {lit_.radiance().begin(), lit_.radiance().end()};
    }
    static cubemap::LightLayer disc(const glm::dvec3& direction) {
        return {.name = "Disc",
                .region = cubemap::Disc{.direction = direction, .radius_degrees = 10.0}};
    }
    [[nodiscard]] glm::dvec3 direction_of(std::size_t index) const {
        return std::get<cubemap::Disc>(desk_->layers()[index].region).direction;
    }

    LitScene lit_ = scenes::relit_clusters();
    std::optional<LightDesk> desk_;
    std::optional<Gestures> hand_;
};

TEST_F(LightDeskTest, AddsNamesSelectsReordersAndRemoves) {
    add(*desk_, disc({1, 1, 0}));
    const std::size_t second = add(*desk_, disc({0, 1, 1}));
    EXPECT_EQ(desk_->layers()[second].name, "Disc 2");
    EXPECT_EQ(desk_->selected(), second);
    reorder(*desk_, 1, 0);
    EXPECT_EQ(desk_->layers()[0].name, "Disc 2");
    EXPECT_EQ(desk_->selected(), 0u);
    remove(*desk_, 0);
    EXPECT_EQ(desk_->layers().size(), 1u);
    EXPECT_FALSE(desk_->selected());
    for (int i = 0; i < 4; ++i)
        desk_->undo();
    EXPECT_TRUE(desk_->layers().empty());
}

TEST_F(LightDeskTest, ADragIsManyEditsAndOneStepOfUndo) {
    add(*desk_, disc({1, 1, 0}));
    const std::vector<glm::vec3> before = radiance();
    const Held held = held_at(*desk_, {1, 1, 0}, 1.0);
    ASSERT_EQ(held.grip, Grip::Body);
    hand_->begin_drag(held, {1, 1, 0});
    for (const double z : {0.2, 0.5, 1.0}) {
        const std::uint64_t version = desk_->version();
        hand_->move_to({1, 1, z});
        EXPECT_GT(desk_->version(), version);
        EXPECT_GT(desk_->last_cost().report.num_clusters, 0u);
    }
    hand_->end();
    EXPECT_EQ(hand_->seconds().size(), 3u);
    EXPECT_LT(angle_between(direction_of(0), {1, 1, 1}), 1e-6);
    EXPECT_NE(radiance(), before);
    const std::vector<glm::vec3> after = radiance();
    desk_->undo();
    EXPECT_EQ(radiance(), before);
    desk_->redo();
    EXPECT_EQ(radiance(), after);
}

TEST_F(LightDeskTest, DirectionsAreAsSeenAfterTheRotation) {
    set_rotation(*desk_, 90.0);
    add(*desk_, disc({0, 0, 1})); // is seen at +X
    EXPECT_EQ(held_at(*desk_, {0, 0, 1}, 1.0).grip, Grip::None);
    ASSERT_EQ(held_at(*desk_, {1, 0, 0}, 1.0).grip, Grip::Body);
    hand_->begin_drag(held_at(*desk_, {1, 0, 0}, 1.0), {1, 0, 0});
    hand_->move_to({1, 1, 0});
    hand_->end();
    EXPECT_LT(angle_between(direction_of(0), {0, 1, 1}), 1e-6);
}

TEST_F(LightDeskTest, RotationAndBaseAreStepsOfUndoAndTheFilesNameFollows) {
    set_base(*desk_, environment(cubemap::CubeMap(64, glm::vec3(0.1f)), "first.exr"));
    add(*desk_, disc({1, 1, 0}));
    const std::vector<glm::vec3> before = radiance();
    for (const double degrees : {10.0, 20.0, 30.0}) // a slider moves: one step
        set_rotation(*desk_, degrees);
    desk_->finish();
    const std::vector<glm::vec3> turned = radiance();
    EXPECT_NE(turned, before);
    set_base(*desk_, environment(cubemap::CubeMap(32, glm::vec3(0.7f)), "second.hdr"));
    desk_->finish();
    EXPECT_EQ(desk_->state().base->path(), "second.hdr");
    static_cast<void>(desk_->take_changed_texels());
    desk_->undo();
    EXPECT_EQ(desk_->state().base->path(), "first.exr");
    EXPECT_EQ(radiance(), turned);
    EXPECT_EQ(desk_->take_changed_texels(), cubemap::all_texels(64));
    desk_->undo();
    EXPECT_EQ(lit_.environment().state().rotation_degrees, 0.0);
    EXPECT_EQ(radiance(), before);
    desk_->redo();
    desk_->redo();
    EXPECT_EQ(desk_->state().base->path(), "second.hdr");
    EXPECT_EQ(environment_of(lit_).resolution, 32u);
}

TEST_F(LightDeskTest, ALassoIsDrawnAsSeenAndIsOneStepOfUndo) {
    const cubemap::LightLayer dim{.name = "Lasso",
                                  .region = cubemap::Lasso{.points = {}, .softness_degrees = 2.0},
                                  .effect = cubemap::Gain{.factor = 0.0f}};
    set_rotation(*desk_, 90.0);
    desk_->finish();
    const std::vector<glm::vec3> before = radiance();
    hand_->begin_lasso({1, 0.5, 0.5});
    hand_->move_to({1, 0.501, 0.5}, 1.0); // too near to count
    EXPECT_EQ(hand_->lasso().size(), 1u);
    hand_->move_to({1, 0.5, -0.5}, 1.0);
    EXPECT_FALSE(hand_->end_lasso(dim)) << "two points are no outline";
    EXPECT_TRUE(desk_->layers().empty());

    hand_->begin_lasso({1, 0.5, 0.5});
    for (const glm::dvec3 to : {glm::dvec3(1, 0.5, -0.5), {1, -0.5, -0.5}, {1, -0.5, 0.5}})
        hand_->move_to(to, 1.0);
    EXPECT_EQ(radiance(), before) << "nothing changes before the end";
    EXPECT_TRUE(hand_->end_lasso(dim));
    EXPECT_TRUE(hand_->lasso().empty());
    ASSERT_EQ(desk_->layers().size(), 1u);
    EXPECT_EQ(desk_->selected(), 0u);
    EXPECT_EQ(held_at(*desk_, {1, 0, 0}, 1.0).grip, Grip::Body) << "where it was drawn, turned";
    EXPECT_EQ(cubemap::coverage(desk_->layers()[0].region, {0, 0, 1}), 1.0) << "before the turn";
    EXPECT_NE(radiance(), before);
    desk_->undo();
    EXPECT_TRUE(desk_->layers().empty());
    EXPECT_EQ(radiance(), before);

    hand_->begin_lasso({0, 1, 0.1});
    for (const glm::dvec3 to : {glm::dvec3(1, -0.2, 0), {-0.5, -0.2, 0.8}, {-0.5, -0.2, -0.8}})
        hand_->move_to(to, 1.0);
    EXPECT_THROW(hand_->end_lasso(dim), std::invalid_argument);
    EXPECT_TRUE(desk_->layers().empty());
}

TEST_F(LightDeskTest, PaintsAStrokePointByPoint) {
    cubemap::LightLayer brush{.name = "Stroke",
                              .region = cubemap::Stroke{.points = {}, .radius_degrees = 4.0}};
    hand_->begin_stroke(brush, {0, 0.5, 1});
    hand_->move_to({0.001, 0.5, 1}); // too near to count
    hand_->move_to({0.2, 0.5, 1});
    hand_->end();
    ASSERT_EQ(desk_->layers().size(), 1u);
    EXPECT_EQ(std::get<cubemap::Stroke>(desk_->layers()[0].region).points.size(), 2u);
    desk_->undo();
    EXPECT_TRUE(desk_->layers().empty());
}

/// A copy kept by the told rectangles alone is always the whole environment.
TEST_F(LightDeskTest, ToldTexelsHoldEveryChange) {
    cubemap::CubeMap copy(64);
    const auto update = [&] {
        for (const cubemap::TexelRectangle& part : desk_->take_changed_texels())
            for (std::uint32_t y = part.y0; y < part.y1; ++y)
                for (std::uint32_t x = part.x0; x < part.x1; ++x)
                    copy.at(part.face, x, y) = environment_of(lit_).at(part.face, x, y);
        return copy.texels == environment_of(lit_).texels;
    };
    EXPECT_TRUE(update());
    add(*desk_, disc({1, 1, 1}));
    EXPECT_TRUE(update());
    hand_->begin_drag({.index = 0, .grip = Grip::Body}, {1, 1, 1});
    hand_->move_to({1, -0.2, 1});
    EXPECT_TRUE(update());
    hand_->end();
    EXPECT_TRUE(update());
    add(*desk_, {.name = "Gain",
                 .region = cubemap::Disc{.direction = {1, 0, 1}, .radius_degrees = 30.0},
                 .effect = cubemap::Gain{.factor = 0.5f}});
    EXPECT_TRUE(update());
    reorder(*desk_, 0, 1);
    EXPECT_TRUE(update());
    set_rotation(*desk_, 33.0);
    EXPECT_TRUE(update());
    desk_->undo();
    EXPECT_TRUE(update());
    remove(*desk_, 0);
    EXPECT_TRUE(update());
}

/// A lamp of side 1 that hangs 1 above a floor of side 2.
LitScene lamp_over_floor() {
    mesh::TriangleMesh mesh;
    mesh.groups = {"floor", "lamp"};
    mesh.materials = {{.name = "floor"}, {.name = "lamp", .emission = glm::vec3(2.0f)}};
    mesh.positions = {{-1, 0, -1},       {-1, 0, 1},       {1, 0, 1},       {1, 0, -1},
                      {-0.5f, 1, -0.5f}, {0.5f, 1, -0.5f}, {0.5f, 1, 0.5f}, {-0.5f, 1, 0.5f}};
    mesh.normals.assign(4, {0, 1, 0});
    mesh.normals.resize(8, {0, -1, 0});
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
    mesh.triangle_groups = mesh.triangle_materials = {0, 0, 1, 1};
    LitScene lit(precompute(std::move(mesh),
                            {.tolerance = 0.2f, .no_refine = true, .bounce_tolerance = 0.0f}));
    lit.environment().edit(
        {.base = base_of(
             Environment{.map = cubemap::CubeMap(8), .file = {}, .assumptions = {}, .path = {}})});
    return lit;
}

TEST(LightDeskLamps, DimmersAreFactorsOnTheirLight) {
    LitScene lit = lamp_over_floor();
    LightDesk desk(lit);
    const float before = desk.lit().radiance()[0].g;
    ASSERT_GT(before, 0.01f);
    const std::uint64_t version = desk.version();
    set_dimmer(desk, "lamp", {0.5f, 1.0f, 2.0f});
    EXPECT_GT(desk.version(), version) << "the window draws again";
    set_dimmer(desk, "", glm::vec3(3.0f));
    EXPECT_EQ(dimmer(desk, "lamp"), glm::vec3(0.5f, 1.0f, 2.0f));
    EXPECT_EQ(dimmer(desk, ""), glm::vec3(3.0f));
    EXPECT_NEAR(desk.lit().radiance()[0].r, 1.5f * before, 1e-4f);
    EXPECT_NEAR(desk.lit().radiance()[0].b, 6.0f * before, 1e-4f);
    set_dimmer(desk, "lamp", glm::vec3(0.0f));
    EXPECT_EQ(desk.lit().radiance()[0], glm::vec3(0.0f));
    EXPECT_THROW(set_dimmer(desk, "lmap", glm::vec3(1.0f)), std::invalid_argument);
    EXPECT_EQ(dimmer(desk, "lamp"), glm::vec3(0.0f));
}

TEST(LightDeskBounces, GoOnFrameByFrameUntilTheLightStands) {
    const relight::BouncingScene scene(scenes::sphere_and_box_on_floor(), 0.05f, 0.05f);
    LitScene lit(scenes::whole_bouncing_scene(scene), {.clusters_only = true});
    lit.light(cubemap::CubeMap(16, glm::vec3(1.0f)));
    const std::vector<glm::vec3> albedo(scene.receivers.size(), glm::vec3(0.8f));
    lit.bounce({.albedo = albedo});
    LightDesk desk(lit);
    std::uint64_t version = desk.version();
    desk.bounce();
    EXPECT_EQ(desk.version(), version) << "nothing has changed";

    cubemap::LightLayer disc{.name = "Disc"};
    disc.gain_ev = 3.0;
    disc.region = cubemap::Disc{.direction = {0, 1, 0}, .radius_degrees = 40.0};
    const std::size_t index = add(desk, disc);
    EXPECT_TRUE(lit.bounces().is_settled()) << "a step of undo has all bounces";
    disc.gain_ev = 5.0;
    change(desk, index, disc);
    int num_frames = 0;
    for (; !lit.bounces().is_settled() && num_frames < 100; ++num_frames) {
        version = desk.version();
        desk.bounce();
        EXPECT_GT(desk.version(), version);
    }
    EXPECT_GT(num_frames, 1);
    EXPECT_LT(num_frames, 20);
    const std::vector<glm::vec3> stepped(lit.radiance().begin(), lit.radiance().end());
    version = desk.version();
    desk.bounce();
    desk.bounce(true);
    EXPECT_EQ(desk.version(), version);
    lit.bounce();
    for (std::size_t i = 0; i < stepped.size(); ++i)
        EXPECT_NEAR(stepped[i].g, lit.radiance()[i].g, 5e-3f * (1.0f + stepped[i].g));
}

} // namespace
} // namespace relumine::viewer
