#include "viewer/light_desk.h"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "tests/relight/bounces/bouncing_scene.h"
#include "tests/relight/relit_scene.h"

namespace relumine::viewer {
namespace {

class LightDeskTest : public testing::Test {
protected:
    LightDeskTest() { desk_.set_base(cubemap::CubeMap(64, glm::vec3(0.1f))); }

    [[nodiscard]] std::vector<glm::vec3> radiance() const {
        return {editor_.radiance().begin(), editor_.radiance().end()};
    }
    static cubemap::LightLayer disc(const glm::dvec3& direction) {
        return {.name = "Disc",
                .region = cubemap::Disc{.direction = direction, .radius_degrees = 10.0}};
    }
    [[nodiscard]] glm::dvec3 direction_of(std::size_t index) const {
        return std::get<cubemap::Disc>(desk_.layers()[index].region).direction;
    }

    relight::LightEditor editor_{scenes::relit_scene().transfer};
    LightDesk desk_{editor_};
};

TEST_F(LightDeskTest, AddsNamesSelectsReordersAndRemoves) {
    desk_.add(disc({1, 1, 0}));
    const std::size_t second = desk_.add(disc({0, 1, 1}));
    EXPECT_EQ(desk_.layers()[second].name, "Disc 2");
    EXPECT_EQ(desk_.selected(), second);
    desk_.reorder(1, 0);
    EXPECT_EQ(desk_.layers()[0].name, "Disc 2");
    EXPECT_EQ(desk_.selected(), 0u);
    desk_.remove(0);
    EXPECT_EQ(desk_.layers().size(), 1u);
    EXPECT_FALSE(desk_.selected());
    for (int i = 0; i < 4; ++i)
        desk_.undo();
    EXPECT_TRUE(desk_.layers().empty());
}

TEST_F(LightDeskTest, ADragIsManyEditsAndOneStepOfUndo) {
    desk_.add(disc({1, 1, 0}));
    const std::vector<glm::vec3> before = radiance();
    const LightDesk::Held held = desk_.held_at({1, 1, 0}, 1.0);
    ASSERT_EQ(held.grip, Grip::Body);
    desk_.begin_drag(held, {1, 1, 0});
    for (const double z : {0.2, 0.5, 1.0}) {
        const std::uint64_t version = desk_.version();
        desk_.drag_to({1, 1, z});
        EXPECT_GT(desk_.version(), version);
        EXPECT_GT(desk_.last_cost().report.num_clusters, 0u);
    }
    desk_.end_drag();
    EXPECT_EQ(desk_.drag_seconds().size(), 3u);
    EXPECT_LT(angle_between(direction_of(0), {1, 1, 1}), 1e-6);
    EXPECT_NE(radiance(), before);
    const std::vector<glm::vec3> after = radiance();
    desk_.undo();
    EXPECT_EQ(radiance(), before);
    desk_.redo();
    EXPECT_EQ(radiance(), after);
}

TEST_F(LightDeskTest, DirectionsAreAsSeenAfterTheRotation) {
    desk_.set_rotation(90.0);
    desk_.add(disc({0, 0, 1})); // is seen at +X
    EXPECT_EQ(desk_.held_at({0, 0, 1}, 1.0).grip, Grip::None);
    ASSERT_EQ(desk_.held_at({1, 0, 0}, 1.0).grip, Grip::Body);
    desk_.begin_drag(desk_.held_at({1, 0, 0}, 1.0), {1, 0, 0});
    desk_.drag_to({1, 1, 0});
    desk_.end_drag();
    EXPECT_LT(angle_between(direction_of(0), {0, 1, 1}), 1e-6);
}

TEST_F(LightDeskTest, RotationAndBaseAreStepsOfUndoAndTheFilesNameFollows) {
    desk_.set_base(cubemap::CubeMap(64, glm::vec3(0.1f)), "first.exr");
    desk_.add(disc({1, 1, 0}));
    const std::vector<glm::vec3> before = radiance();
    for (const double degrees : {10.0, 20.0, 30.0}) // a slider moves: one step
        desk_.set_rotation(degrees);
    desk_.finish();
    const std::vector<glm::vec3> turned = radiance();
    EXPECT_NE(turned, before);
    desk_.set_base(cubemap::CubeMap(32, glm::vec3(0.7f)), "second.hdr");
    desk_.finish();
    EXPECT_EQ(desk_.base_path(), "second.hdr");
    static_cast<void>(desk_.take_changed_texels());
    desk_.undo();
    EXPECT_EQ(desk_.base_path(), "first.exr");
    EXPECT_EQ(radiance(), turned);
    EXPECT_EQ(desk_.take_changed_texels(), cubemap::all_texels(64));
    desk_.undo();
    EXPECT_EQ(editor_.rotation(), 0.0);
    EXPECT_EQ(radiance(), before);
    desk_.redo();
    desk_.redo();
    EXPECT_EQ(desk_.base_path(), "second.hdr");
    EXPECT_EQ(editor_.environment().resolution, 32u);
}

TEST_F(LightDeskTest, ALassoIsDrawnAsSeenAndIsOneStepOfUndo) {
    const cubemap::LightLayer dim{.name = "Lasso",
                                  .region = cubemap::Lasso{.points = {}, .softness_degrees = 2.0},
                                  .effect = cubemap::Gain{.factor = 0.0f}};
    desk_.set_rotation(90.0);
    desk_.finish();
    const std::vector<glm::vec3> before = radiance();
    desk_.begin_lasso({1, 0.5, 0.5});
    desk_.lasso_to({1, 0.501, 0.5}, 1.0); // too near to count
    EXPECT_EQ(desk_.lasso().size(), 1u);
    desk_.lasso_to({1, 0.5, -0.5}, 1.0);
    EXPECT_FALSE(desk_.end_lasso(dim)) << "two points are no outline";
    EXPECT_TRUE(desk_.layers().empty());

    desk_.begin_lasso({1, 0.5, 0.5});
    for (const glm::dvec3 to : {glm::dvec3(1, 0.5, -0.5), {1, -0.5, -0.5}, {1, -0.5, 0.5}})
        desk_.lasso_to(to, 1.0);
    EXPECT_EQ(radiance(), before) << "nothing changes before the end";
    EXPECT_TRUE(desk_.end_lasso(dim));
    EXPECT_TRUE(desk_.lasso().empty());
    ASSERT_EQ(desk_.layers().size(), 1u);
    EXPECT_EQ(desk_.selected(), 0u);
    EXPECT_EQ(desk_.held_at({1, 0, 0}, 1.0).grip, Grip::Body) << "where it was drawn, turned";
    EXPECT_EQ(cubemap::coverage(desk_.layers()[0].region, {0, 0, 1}), 1.0) << "before the turn";
    EXPECT_NE(radiance(), before);
    desk_.undo();
    EXPECT_TRUE(desk_.layers().empty());
    EXPECT_EQ(radiance(), before);

    desk_.begin_lasso({0, 1, 0.1});
    for (const glm::dvec3 to : {glm::dvec3(1, -0.2, 0), {-0.5, -0.2, 0.8}, {-0.5, -0.2, -0.8}})
        desk_.lasso_to(to, 1.0);
    EXPECT_THROW(desk_.end_lasso(dim), std::invalid_argument);
    EXPECT_TRUE(desk_.layers().empty());
}

TEST_F(LightDeskTest, PaintsAStrokePointByPoint) {
    cubemap::LightLayer brush{.name = "Stroke",
                              .region = cubemap::Stroke{.points = {}, .radius_degrees = 4.0}};
    desk_.begin_stroke(brush, {0, 0.5, 1});
    desk_.stroke_to({0.001, 0.5, 1}); // too near to count
    desk_.stroke_to({0.2, 0.5, 1});
    desk_.end_stroke();
    ASSERT_EQ(desk_.layers().size(), 1u);
    EXPECT_EQ(std::get<cubemap::Stroke>(desk_.layers()[0].region).points.size(), 2u);
    desk_.undo();
    EXPECT_TRUE(desk_.layers().empty());
}

/// A copy kept by the told rectangles alone is always the whole environment.
TEST_F(LightDeskTest, ToldTexelsHoldEveryChange) {
    cubemap::CubeMap copy(64);
    const auto update = [&] {
        for (const cubemap::TexelRectangle& part : desk_.take_changed_texels())
            for (std::uint32_t y = part.y0; y < part.y1; ++y)
                for (std::uint32_t x = part.x0; x < part.x1; ++x)
                    copy.at(part.face, x, y) = editor_.environment().at(part.face, x, y);
        return copy.texels == editor_.environment().texels;
    };
    EXPECT_TRUE(update());
    desk_.add(disc({1, 1, 1}));
    EXPECT_TRUE(update());
    desk_.begin_drag({.index = 0, .grip = Grip::Body}, {1, 1, 1});
    desk_.drag_to({1, -0.2, 1});
    EXPECT_TRUE(update());
    desk_.end_drag();
    EXPECT_TRUE(update());
    desk_.add({.name = "Gain",
               .region = cubemap::Disc{.direction = {1, 0, 1}, .radius_degrees = 30.0},
               .effect = cubemap::Gain{.factor = 0.5f}});
    EXPECT_TRUE(update());
    desk_.reorder(0, 1);
    EXPECT_TRUE(update());
    desk_.set_rotation(33.0);
    EXPECT_TRUE(update());
    desk_.undo();
    EXPECT_TRUE(update());
    desk_.remove(0);
    EXPECT_TRUE(update());
}

TEST(LightDeskBounces, GoOnFrameByFrameUntilTheLightStands) {
    const relight::BouncingScene scene(scenes::sphere_and_box_on_floor(), 0.05f, 0.05f);
    relight::LightEditor editor(scene.transfer);
    editor.set_bounces(
        {.matrix = &scene.matrix, .albedo = std::vector(scene.receivers.size(), glm::vec3(0.8f))});
    LightDesk desk(editor);
    desk.set_base(cubemap::CubeMap(16, glm::vec3(1.0f)));
    desk.settle();
    std::uint64_t version = desk.version();
    desk.go_on();
    EXPECT_EQ(desk.version(), version) << "nothing has changed";

    cubemap::LightLayer disc{.name = "Disc"};
    disc.gain_ev = 3.0;
    disc.region = cubemap::Disc{.direction = {0, 1, 0}, .radius_degrees = 40.0};
    const std::size_t index = desk.add(disc);
    EXPECT_TRUE(editor.is_settled()) << "a step of undo has all bounces";
    disc.gain_ev = 5.0;
    desk.change(index, disc);
    int num_frames = 0;
    for (; !editor.is_settled() && num_frames < 100; ++num_frames) {
        version = desk.version();
        desk.go_on();
        EXPECT_GT(desk.version(), version);
    }
    EXPECT_GT(num_frames, 1);
    EXPECT_LT(num_frames, 20);
    const std::vector<glm::vec3> stepped(editor.radiance().begin(), editor.radiance().end());
    version = desk.version();
    desk.go_on();
    desk.settle();
    EXPECT_EQ(desk.version(), version);
    editor.settle();
    for (std::size_t i = 0; i < stepped.size(); ++i)
        EXPECT_NEAR(stepped[i].g, editor.radiance()[i].g, 5e-3f * (1.0f + stepped[i].g));
}

} // namespace
} // namespace relumine::viewer
