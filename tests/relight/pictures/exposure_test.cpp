#include "relight/pictures/exposure.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace relumine::relight {
namespace {

TEST(SuitableExposure, PutsTheBrightPartsBelowWhite) {
    for (const float brightness : {1e-6f, 0.02f, 0.8f, 3.0f, 500.0f})
        EXPECT_NEAR(suitable_exposure_ev(std::vector(100, glm::vec3(brightness))),
                    std::log2(0.8f / brightness), 0.0051f);
    // The largest channel counts.
    EXPECT_NEAR(suitable_exposure_ev(std::vector(9, glm::vec3(0.1f, 3.2f, 0.0f))), -2.0f, 1e-6f);
    // In hundredths of a stop, so that the printed value gives the same picture.
    const float ev = suitable_exposure_ev(std::vector(100, glm::vec3(0.123f)));
    EXPECT_NEAR(100.0f * ev, std::round(100.0f * ev), 1e-3f);
}

TEST(SuitableExposure, AFewGlintsDoNotDarkenIt) {
    std::vector<glm::vec3> colors(1000, glm::vec3(0.4f));
    for (std::size_t i = 0; i < 40; ++i)
        colors[i] = glm::vec3(1000.0f);
    EXPECT_NEAR(suitable_exposure_ev(colors), 1.0f, 1e-6f);
    for (std::size_t i = 40; i < 60; ++i)
        colors[i] = glm::vec3(1000.0f);
    EXPECT_LT(suitable_exposure_ev(colors), -8.0f);
}

TEST(SuitableExposure, LiftsWhatIsMostlyDark) {
    std::vector<glm::vec3> colors(1000, glm::vec3(0.0f));
    std::fill(colors.begin(), colors.begin() + 100, glm::vec3(0.8f));
    EXPECT_EQ(suitable_exposure_ev(colors), 1.5f);
    std::fill(colors.begin() + 100, colors.end(), glm::vec3(0.05f));
    EXPECT_EQ(suitable_exposure_ev(colors), 1.0f);
    std::fill(colors.begin() + 100, colors.end(), glm::vec3(0.2f));
    EXPECT_EQ(suitable_exposure_ev(colors), 0.0f);
}

TEST(SuitableExposure, WeightsCount) {
    const std::vector<glm::vec3> colors = {glm::vec3(1.6f), glm::vec3(0.4f), glm::vec3(99.0f)};
    EXPECT_EQ(suitable_exposure_ev(colors, std::vector{1.0f, 1.0f, 0.0f}), -1.0f);
    EXPECT_EQ(suitable_exposure_ev(colors, std::vector{0.01f, 1.0f, 0.0f}), 1.0f);
}

TEST(SuitableExposure, OfNothingIsZero) {
    EXPECT_EQ(suitable_exposure_ev(std::vector(100, glm::vec3(0.0f))), 0.0f);
    EXPECT_EQ(suitable_exposure_ev({}), 0.0f);
    EXPECT_EQ(suitable_exposure_ev(std::vector(3, glm::vec3(1.0f)), std::vector(3, 0.0f)), 0.0f);
    EXPECT_EQ(suitable_exposure_ev(std::vector(3, glm::vec3(1e38f))), -100.0f);
}

TEST(Exposure, LeavesAPhotographBehindAsItIs) {
    const std::vector<glm::vec3> dark(100, glm::vec3(0.1f)), bright(100, glm::vec3(1.0f));
    const float alone = suitable_exposure_ev(dark);
    EXPECT_NEAR(alone, 3.0f, 1e-6f);
    // A photograph that is no brighter changes nothing; a bright one must not burn out.
    EXPECT_EQ(suitable_exposure_ev(dark, {}, dark), alone);
    EXPECT_NEAR(suitable_exposure_ev(dark, {}, bright), std::log2(1.4f), 0.005f);
    // Nor is it left in the dark by something white.
    EXPECT_NEAR(suitable_exposure_ev(bright, {}, dark), suitable_exposure_ev(bright) + 0.6f, 0.01f);
    // But what is lit stays visible.
    const std::vector<glm::vec3> black(100, glm::vec3(0.001f));
    EXPECT_NEAR(suitable_exposure_ev(black, {}, bright), suitable_exposure_ev(black) - 3.0f, 0.01f);
    EXPECT_EQ(suitable_exposure_ev({}, {}, bright), suitable_exposure_ev(bright));
}

TEST(Exposure, DoesNotBurnTheFloor) {
    const std::vector<glm::vec3> lit(100, glm::vec3(0.8f));
    const float alone = suitable_exposure_ev(lit);
    const auto with_floor = [&](float brightness, std::size_t num_bright) {
        std::vector<glm::vec3> floor(200, glm::vec3(0.1f));
        std::fill_n(floor.begin(), num_bright, glm::vec3(brightness));
        return suitable_exposure_ev(lit, {}, {}, {.colors = floor, .share = 0.001});
    };
    // A pool of light may burn out in a fiftieth of the picture, and not in more of it.
    EXPECT_EQ(with_floor(5.6f, 20), alone);
    EXPECT_NEAR(with_floor(5.6f, 21), -2.0f, 0.01f);
    EXPECT_EQ(with_floor(1.0f, 200), alone);
    // What is lit stays visible.
    EXPECT_NEAR(with_floor(1e4f, 200), alone - 3.0f, 0.01f);
}

} // namespace
} // namespace relumine::relight
