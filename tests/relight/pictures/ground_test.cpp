#include "relight/pictures/ground.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

namespace relumine::relight {
namespace {

/// Colours are directions.
glm::vec3 directions(const glm::vec3& w) {
    return w;
}

constexpr Ground Level{.camera = {1.0, 3.0, 2.0}, .height = 2.0, .reach = 40.0};

TEST(Ground, LooksAsPhotographedFromTheCamera) {
    const Backdrop seen = grounded_backdrop(directions, Level, glm::vec3(Level.camera));
    for (int i = 0; i < 200; ++i) {
        const float up = static_cast<float>(i) / 100.0f - 0.995f;
        const glm::vec3 w(std::sqrt(1.0f - up * up) * glm::vec3(0.6f, 0.0f, 0.8f) +
                          glm::vec3(0.0f, up, 0.0f));
        EXPECT_LT(glm::distance(seen(w), w), 1e-5f);
    }
}

TEST(Ground, LiesFlatAndStaysInPlace) {
    // The point (4, 1, 6) of the ground, seen from two places.
    const glm::vec3 point(4.0f, 1.0f, 6.0f);
    for (const glm::vec3& eye : {glm::vec3(0.0f, 2.0f, 0.0f), glm::vec3(9.0f, 5.0f, -3.0f)}) {
        const Backdrop seen = grounded_backdrop(directions, Level, eye);
        EXPECT_LT(glm::distance(seen(glm::normalize(point - eye)),
                                glm::normalize(point - glm::vec3(Level.camera))),
                  1e-5f);
    }
}

TEST(Ground, HasNoSeam) {
    const Backdrop seen = grounded_backdrop(directions, Level, {4.0f, 4.5f, -3.0f});
    glm::vec3 before = seen({0.0f, -1.0f, 0.0f});
    constexpr int Steps = 4000;
    for (int i = 1; i <= Steps; ++i) {
        const float angle = std::numbers::pi_v<float> * (static_cast<float>(i) / Steps - 0.5f);
        const glm::vec3 now = seen({std::cos(angle), std::sin(angle), 0.0f});
        EXPECT_LT(glm::distance(now, before), 0.01f) << angle;
        before = now;
    }
}

TEST(Ground, IsNotSeenFromBelowAndReachesAnEyeOutside) {
    const glm::vec3 w(0.6f, 0.8f, 0.0f);
    EXPECT_EQ(grounded_backdrop(directions, Level, {0.0f, 0.5f, 0.0f})(w), w);
    const glm::vec3 far = grounded_backdrop(directions, Level, {500.0f, 90.0f, 0.0f})(w);
    EXPECT_NEAR(glm::length(far), 1.0f, 1e-5f);
}

TEST(Ground, OfAStudioEndsFarAway) {
    const glm::vec3 eye(1.0f, 4.0f, 2.0f), grey(0.5f);
    const Backdrop seen = sweep_backdrop(plain_backdrop(glm::vec3(0.0f)), grey, Level, eye);
    EXPECT_EQ(seen({0.0f, -1.0f, 0.0f}), grey);
    EXPECT_EQ(seen({1.0f, 0.0f, 0.0f}), glm::vec3(0.0f));
    EXPECT_EQ(seen(glm::normalize(glm::vec3(1.0f, -0.01f, 0.0f))), glm::vec3(0.0f));
    EXPECT_EQ(seen({0.0f, 1.0f, 0.0f}), glm::vec3(0.0f));
}

/// A white sky; below the horizon a chessboard of two colours.
cubemap::CubeMap sky_over(float one, float other) {
    cubemap::CubeMap map(16, glm::vec3(1.0f));
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < 16; ++y)
            for (std::uint32_t x = 0; x < 16; ++x)
                if (cubemap::texel_direction(face, x, y, 16).y < 0.0)
                    map.at(face, x, y) = glm::vec3((x + y) % 2 == 0 ? one : other);
    return map;
}

TEST(Ground, IsFoundWhereTheMapShowsOne) {
    EXPECT_TRUE(has_ground(sky_over(0.2f, 0.3f), glm::vec3(1.0f)));
    EXPECT_TRUE(has_ground(sky_over(0.0f, 0.06f), glm::vec3(1.0f)));
    EXPECT_FALSE(has_ground(sky_over(0.0f, 0.0f), glm::vec3(1.0f)));
    EXPECT_FALSE(has_ground(sky_over(0.01f, 0.015f), glm::vec3(1.0f)));
    EXPECT_FALSE(has_ground(sky_over(0.3f, 0.3f), glm::vec3(1.0f)));
}

TEST(Ground, ALampThatStandsOnItIsNoneOfIt) {
    const auto with_lamp = [](double height) {
        cubemap::CubeMap map = sky_over(0.2f, 0.3f);
        for (std::uint32_t y = 0; y < 16; ++y)
            for (std::uint32_t x = 6; x < 10; ++x)
                if (std::abs(cubemap::texel_direction(cubemap::Face::PositiveZ, x, y, 16).y -
                             height) < 0.1)
                    map.at(cubemap::Face::PositiveZ, x, y) = glm::vec3(4.0f);
        return has_ground(map, glm::vec3(1.0f));
    };
    EXPECT_FALSE(with_lamp(-0.1));
    EXPECT_TRUE(with_lamp(0.4)) << "it hangs over the ground";
}

} // namespace
} // namespace relumine::relight
