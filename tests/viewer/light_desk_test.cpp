#include "viewer/light_desk.h"

#include <vector>

#include <gtest/gtest.h>

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
        return {.name = "Disc", .region = cubemap::Disc{.direction = direction, .radius_degrees = 10.0}};
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

} // namespace
} // namespace relumine::viewer
