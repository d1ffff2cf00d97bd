#include "relight/pictures/tone_curve.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace relumine::relight {
namespace {

constexpr std::array<ToneCurve, ToneCurves.size()> All = [] {
    std::array<ToneCurve, ToneCurves.size()> all{};
    for (std::size_t i = 0; i < all.size(); ++i)
        all[i] = static_cast<ToneCurve>(i);
    return all;
}();

TEST(ToneCurve, Names) {
    EXPECT_EQ(tone_curve("neutral"), ToneCurve::Neutral);
    EXPECT_EQ(tone_curve("agx"), ToneCurve::Agx);
    EXPECT_EQ(tone_curve("aces"), ToneCurve::Aces);
    EXPECT_EQ(tone_curve("none"), ToneCurve::None);
    EXPECT_FALSE(tone_curve("reinhard"));
}

TEST(ToneCurve, GreyStaysGreyAndGrowsFromBlackToWhite) {
    for (const ToneCurve curve : All) {
        float last = -1.0f;
        for (float x = 1e-3f; x < 1e9f; x *= 1.1f) {
            const glm::vec3 shown = on_screen(curve, glm::vec3(x));
            EXPECT_NEAR(shown.r, shown.g, 2e-3f);
            EXPECT_NEAR(shown.b, shown.g, 2e-3f);
            EXPECT_GE(shown.g, last - 1e-6f) << x;
            EXPECT_GE(shown.g, 0.0f);
            EXPECT_LE(shown.g, 1.0f);
            last = shown.g;
        }
        EXPECT_GT(last, 0.97f);
        EXPECT_LT(on_screen(curve, glm::vec3(0.0f)).g, 1e-3f);
        EXPECT_LT(on_screen(curve, glm::vec3(-5.0f)).g, 1e-3f);
        EXPECT_LE(on_screen(curve, glm::vec3(1e38f)).g, 1.0f);
    }
}

TEST(ToneCurve, NeutralKeepsColoursBelowWhite) {
    // The specification: what is not compressed loses 0.04, less where a channel is below 0.08.
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(0.08f, 0.79f);
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 color(uniform(random), uniform(random), uniform(random));
        const glm::vec3 shown = on_screen(ToneCurve::Neutral, color);
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(shown[channel], color[channel] - 0.04f, 1e-6f);
    }
    EXPECT_NEAR(on_screen(ToneCurve::Neutral, glm::vec3(0.04f)).r, 0.01f, 1e-6f);
    // Its curve for grey: 1 - 0.24^2 / (x - 0.04 + 0.24 - 0.76).
    for (const float x : {1.0f, 2.0f, 10.0f, 100.0f})
        EXPECT_NEAR(on_screen(ToneCurve::Neutral, glm::vec3(x)).g, 1.0f - 0.0576f / (x - 0.56f),
                    1e-5f);
    // Red by far beyond white becomes pink, not a clipped red.
    const glm::vec3 red = on_screen(ToneCurve::Neutral, {50.0f, 0.0f, 0.0f});
    EXPECT_GT(red.g, 0.5f);
    EXPECT_LT(red.r, 1.0f);
}

TEST(ToneCurve, MiddleGreyStaysAboutWhereItIs) {
    for (const ToneCurve curve : All) {
        const float grey = on_screen(curve, glm::vec3(0.18f)).g;
        EXPECT_GT(grey, 0.12f);
        EXPECT_LT(grey, 0.26f);
    }
}

TEST(ToneCurve, KnownValuesOfTheOthers) {
    // ACES: Hill's fit worked out by hand for grey, whose matrices keep it grey.
    const auto hill = [](double v) {
        return (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
    };
    for (const double x : {0.05, 0.18, 1.0, 5.0})
        EXPECT_NEAR(
            static_cast<double>(on_screen(ToneCurve::Aces, glm::vec3(static_cast<float>(x))).g),
            std::min(hill(x / 0.6), 1.0), 2e-3);
    // AgX: the curve's ends are 16.5 stops apart, 2^-12.47 and 2^4.03.
    EXPECT_LT(on_screen(ToneCurve::Agx, glm::vec3(std::exp2(-12.5f))).g, 1e-3f);
    EXPECT_GT(on_screen(ToneCurve::Agx, glm::vec3(std::exp2(4.03f))).g, 0.97f);
    EXPECT_EQ(on_screen(ToneCurve::None, {0.5f, 2.0f, -1.0f}), glm::vec3(0.5f, 1.0f, 0.0f));
}

} // namespace
} // namespace relumine::relight
