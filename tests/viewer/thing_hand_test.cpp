// Things of the scene in the pointer's hand: what a ray takes, where it goes, and what undo does.
#include "viewer/thing_hand.h"

#include <optional>
#include <stdexcept>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "relumine/in/precompute.h"
#include "tests/prt/scenes.h"

namespace relumine::viewer {
namespace {

const glm::vec3 BallMiddle(0.8f, 0.7f, 0.3f);
constexpr glm::vec3 Up(0.0f, 1.0f, 0.0f);

/// A floor and a ball above it.
const Scene& scene() {
    static const Scene result = [] {
        mesh::TriangleMesh mesh = scenes::floor_grid(21, 6.0f);
        const std::size_t num_ground = mesh.num_triangles();
        mesh = scenes::joined(mesh, scenes::icosphere(3, 0.6f, BallMiddle));
        mesh.groups = {"ground", "ball"};
        mesh.triangle_groups.assign(num_ground, 0);
        mesh.triangle_groups.resize(mesh.num_triangles(), 1);
        return precompute(std::move(mesh), {.tolerance = 0.05f,
                                            .face_resolution = 32,
                                            .no_refine = true,
                                            .bounce_tolerance = 0.0f,
                                            .movable = true});
    }();
    return result;
}

Ray towards(const glm::vec3& point, const glm::vec3& eye = {0.0f, 4.0f, 6.0f}) {
    return {.origin = eye, .direction = glm::normalize(point - eye)};
}

class ThingHandTest : public testing::Test {
protected:
    ThingHandTest() {
        lit_.light(cubemap::CubeMap(16, glm::vec3(0.1f)));
        desk_.emplace(lit_);
        hand_.emplace(*desk_);
        first_ = radiance();
    }
    [[nodiscard]] std::vector<glm::vec3> radiance() const {
        return {lit_.radiance().begin(), lit_.radiance().end()};
    }
    [[nodiscard]] glm::vec3 ball() const { return middle_of(lit_.scene(), "ball"); }
    /// Takes the ball and brings its point to another one.
    void drag(const glm::vec3& to, double degrees = 0.0) {
        const glm::vec3 taken = thing_at(lit_, towards(BallMiddle))->point;
        ASSERT_TRUE(hand_->begin(towards(BallMiddle)));
        hand_->move_to(towards(taken + 0.5f * (to - taken)), Up);
        hand_->move_to(towards(to), Up, degrees);
    }

    LitScene lit_ = LitScene(scene());
    std::optional<LightDesk> desk_;
    std::optional<ThingHand> hand_;
    std::vector<glm::vec3> first_;
};

TEST_F(ThingHandTest, ARayTakesWhatItMeetsFirst) {
    const std::optional<SeenThing> seen = thing_at(lit_, towards(BallMiddle));
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->name, "ball");
    EXPECT_NEAR(glm::distance(seen->point, BallMiddle), 0.6f, 0.03f);
    EXPECT_EQ(thing_at(lit_, towards({-2.0f, 0.0f, 0.0f}))->name, "ground");
    EXPECT_FALSE(thing_at(lit_, towards({0.0f, 20.0f, 0.0f})));
    EXPECT_FALSE(hand_->begin(towards({0.0f, 20.0f, 0.0f})));
    EXPECT_FALSE(hand_->is_dragging());
    Scene fixed = scene();
    fixed.settings.is_movable = false;
    const LitScene of_fixed(std::move(fixed));
    EXPECT_THROW(static_cast<void>(thing_at(of_fixed, towards(BallMiddle))), std::invalid_argument);
}

TEST(StepTo, StaysInThePlane) {
    const glm::dvec3 point(1.0, 0.5, -1.0);
    const Ray ray = towards({-1.0f, 0.5f, 2.0f});
    const std::optional<glm::dvec3> level = step_to(point, ray, Up, 100.0);
    ASSERT_TRUE(level);
    EXPECT_NEAR(glm::distance(*level, glm::dvec3(-2.0, 0.0, 3.0)), 0.0, 1e-5);
    const std::optional<glm::dvec3> before = step_to(point, ray, {0.0f, 0.0f, 1.0f}, 100.0);
    ASSERT_TRUE(before);
    EXPECT_NEAR(before->z, 0.0, 1e-6);
    EXPECT_FALSE(step_to(point, ray, Up, 1.0));
    EXPECT_FALSE(step_to(point, {{0.0f, 4.0f, 0.0f}, {1.0f, 0.0f, 0.0f}}, Up, 100.0));
    EXPECT_FALSE(step_to(point, {{0.0f, 4.0f, 0.0f}, {0.0f, 1.0f, 0.0f}}, Up, 100.0));
}

TEST_F(ThingHandTest, ADragMovesOverTheFloorAndIsOneStepOfUndo) {
    const glm::vec3 taken = thing_at(lit_, towards(BallMiddle))->point;
    const glm::vec3 to = taken + glm::vec3(-1.5f, 0.0f, 0.4f);
    drag(to, 30.0);
    EXPECT_TRUE(lit_.moves().is_dragging());
    EXPECT_NE(radiance(), first_);
    EXPECT_NEAR(glm::distance(glm::vec3(hand_->step()->by), to - taken), 0.0f, 1e-4f);
    const GroupMove same = move_of(*hand_->step(), middle_of(scene(), "ball"));
    hand_->end();
    EXPECT_FALSE(hand_->is_dragging());
    EXPECT_FALSE(lit_.moves().is_dragging());
    EXPECT_NEAR(glm::distance(ball(), BallMiddle + (to - taken)), 0.0f, 1e-3f);
    LitScene moved(scene());
    moved.light(cubemap::CubeMap(16, glm::vec3(0.1f)));
    moved.moves().move(same);
    EXPECT_EQ(lit_.scene().mesh.positions, moved.scene().mesh.positions);
    EXPECT_EQ(radiance(), std::vector(moved.radiance().begin(), moved.radiance().end()));
    EXPECT_EQ(hand_->seconds().size(), 2u);
    const std::vector<glm::vec3> after = radiance();
    desk_->undo();
    EXPECT_EQ(lit_.scene().mesh.positions, scene().mesh.positions);
    EXPECT_EQ(radiance(), first_);
    desk_->redo();
    EXPECT_EQ(radiance(), after);
}

TEST_F(ThingHandTest, UndoGoesBackThroughLightAndMovesInTheirOrder) {
    const auto add_disc = [&](float x) {
        add(*desk_, {.name = "key",
                     .region = cubemap::Disc{.direction = {x, 1.0, 0.0}, .radius_degrees = 20.0}});
        return radiance();
    };
    const std::vector<glm::vec3> one = add_disc(1.0f);
    const glm::vec3 taken = thing_at(lit_, towards(BallMiddle))->point;
    drag(taken + glm::vec3(-1.0f, 0.0f, 0.0f));
    hand_->end();
    const std::vector<glm::vec3> two = radiance(), three = add_disc(-1.0f);
    desk_->undo();
    EXPECT_EQ(radiance(), two);
    desk_->undo();
    EXPECT_EQ(radiance(), one);
    desk_->undo();
    EXPECT_EQ(radiance(), first_);
    for (const std::vector<glm::vec3>& expected : {one, two, three}) {
        desk_->redo();
        EXPECT_EQ(radiance(), expected);
    }
}

TEST_F(ThingHandTest, UndoTakesADragBackAndTheHandIsEmpty) {
    int num_stops = 0;
    desk_->on_move([&] { ++num_stops; });
    const auto version = desk_->mesh_version();
    drag(BallMiddle + glm::vec3(-1.0f, 0.0f, 0.0f));
    EXPECT_EQ(num_stops, 2);
    EXPECT_EQ(desk_->mesh_version(), version + 2);
    desk_->undo();
    EXPECT_EQ(radiance(), first_);
    hand_->move_to(towards(BallMiddle + glm::vec3(1.0f, 0.0f, 0.0f)), Up);
    EXPECT_FALSE(hand_->is_dragging());
    hand_->end();
    EXPECT_EQ(radiance(), first_);
    EXPECT_EQ(num_stops, 3);
}

TEST_F(ThingHandTest, WhatIsHeldCanBeTakenAway) {
    drag(BallMiddle + glm::vec3(-1.0f, 0.0f, 0.0f));
    hand_->take_away();
    EXPECT_FALSE(hand_->is_dragging());
    EXPECT_EQ(thing_at(lit_, towards(BallMiddle))->name, "ground");
    LitScene without(scene());
    without.light(cubemap::CubeMap(16, glm::vec3(0.1f)));
    without.moves().move({.name = "ball", .going = Going::Away});
    EXPECT_EQ(radiance(), std::vector(without.radiance().begin(), without.radiance().end()));
    desk_->undo();
    EXPECT_EQ(radiance(), first_);
}

} // namespace
} // namespace relumine::viewer
