#include "viewer/region_edit.h"

#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace relumine::viewer {
namespace {

using cubemap::Region;

std::vector<Region> all_kinds() {
    return {
        cubemap::Disc{.direction = {1, 2, 3}, .radius_degrees = 12.0},
        cubemap::Rectangle{.direction = {-2, 1, 1},
                           .width_degrees = 50.0,
                           .height_degrees = 20.0,
                           .roll_degrees = 30.0},
        cubemap::Rectangle{.direction = {0, 1, 0}, .width_degrees = 30.0, .height_degrees = 40.0},
        cubemap::Lasso{.points = {{1, 0, 0}, {1, 0.5, 0}, {1, 0.4, 0.5}}},
        cubemap::Stroke{.points = {{0, 0, 1}, {0.2, 0.1, 1}, {0.4, 0, 1}},
                        .radius_degrees = 3.0,
                        .softness = 0.0},
        cubemap::Stroke{.points = {{0, -1, 0.1}}, .radius_degrees = 8.0, .softness = 0.0}};
}

TEST(Outline, SeparatesWhatIsCoveredFromWhatIsNot) {
    for (const Region& region : all_kinds()) {
        const std::vector<glm::dvec3> rim = outline(region);
        EXPECT_LT(glm::length(rim.front() - rim.back()), 1e-9);
        for (std::size_t i = 0; i + 1 < rim.size(); ++i) {
            const glm::dvec3& point = rim[i];
            const glm::dvec3 along = rim[i + 1] - point;
            if (glm::length(along) < 1e-6)
                continue;
            const glm::dvec3 middle_of_piece = point + 0.5 * along;
            const glm::dvec3 across = 0.01 * glm::normalize(glm::cross(along, point));
            const bool left = cubemap::coverage(region, middle_of_piece - across) > 0.0;
            const bool right = cubemap::coverage(region, middle_of_piece + across) > 0.0;
            EXPECT_NE(left, right) << "kind " << region.index() << ", point " << i;
        }
    }
}

TEST(Grip, TellsBodyRimAndNothing) {
    const Region disc =
        cubemap::Disc{.direction = {0, 0, 1}, .radius_degrees = 20.0, .softness = 1.0};
    const auto at = [](double degrees) {
        return turned(glm::dvec3(0, 0, 1), degrees);
    };
    EXPECT_EQ(grip_at(disc, at(0.0), 2.0), Grip::Body);
    EXPECT_EQ(grip_at(disc, at(15.0), 2.0), Grip::Body);
    EXPECT_EQ(grip_at(disc, at(19.0), 2.0), Grip::Rim);
    EXPECT_EQ(grip_at(disc, at(21.0), 2.0), Grip::Rim);
    EXPECT_EQ(grip_at(disc, at(23.0), 2.0), Grip::None);
    const Region sun = cubemap::Disc{.direction = {0, 0, 1}, .radius_degrees = 0.3};
    EXPECT_EQ(grip_at(sun, at(0.1), 2.0), Grip::Body) << "small things can be moved";
    EXPECT_EQ(grip_at(sun, at(0.9), 2.0), Grip::Rim);
}

TEST(Moved, TakesTheMiddleAlong) {
    for (const Region& region : all_kinds()) {
        const glm::dvec3 from = middle(region);
        for (const glm::dvec3 to : {glm::normalize(glm::dvec3(0.3, 0.5, -0.8)), -from}) {
            const Region there = moved(region, from, to);
            EXPECT_LT(angle_between(middle(there), to), 1e-6) << "kind " << region.index();
            EXPECT_NO_THROW(cubemap::validate(there));
        }
    }
}

TEST(Resized, FollowsThePointer) {
    const glm::dvec3 front(0, 0, 1);
    const Region disc = resized(cubemap::Disc{.direction = front, .radius_degrees = 10.0},
                                turned(front, 10.5), turned(front, 25.5));
    EXPECT_NEAR(std::get<cubemap::Disc>(disc).radius_degrees, 25.0, 1e-9);
    // The side of a box at +X, held in its middle: only the width changes.
    const Region box = resized(
        cubemap::Rectangle{.direction = front, .width_degrees = 20.0, .height_degrees = 30.0},
        turned(front, 10.0), turned(front, 20.0));
    EXPECT_NEAR(std::get<cubemap::Rectangle>(box).width_degrees, 40.0, 1e-9);
    EXPECT_NEAR(std::get<cubemap::Rectangle>(box).height_degrees, 30.0, 1e-9);
}

TEST(Resized, StaysValidHoweverFar) {
    for (const Region& region : all_kinds())
        for (const glm::dvec3& to : {-middle(region), middle(region), glm::dvec3(0, 1, 0)})
            EXPECT_NO_THROW(cubemap::validate(resized(region, outline(region)[3], to)))
                << region.index();
}

TEST(Turned, FrontGoesToPlusX) {
    EXPECT_LT(glm::length(turned(glm::dvec3(0, 0, 1), 90.0) - glm::dvec3(1, 0, 0)), 1e-12);
    for (const Region& region : all_kinds()) {
        const Region there = turned(region, 40.0);
        EXPECT_LT(angle_between(turned(middle(region), 40.0), middle(there)), 1e-6);
        for (const glm::dvec3& w : outline(region)) {
            const glm::dvec3 inwards = w + 0.02 * middle(region);
            EXPECT_NEAR(cubemap::coverage(region, inwards),
                        cubemap::coverage(there, turned(inwards, 40.0)), 1e-6);
        }
    }
}

} // namespace
} // namespace relumine::viewer
