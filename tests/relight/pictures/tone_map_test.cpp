#include "relight/pictures/tone_map.h"

#include <vector>

#include <gtest/gtest.h>

namespace relumine::relight {
namespace {

using Samples = std::vector<LuminanceSample>;

TEST(ToneMap, TheGeometricMeanBecomesMiddleGrey) {
    const ToneMap map(Samples{{.luminance = 1.0}, {.luminance = 16.0}});
    EXPECT_NEAR(map(glm::dvec3(4.0)).g, 0.18 / 1.18, 1e-6);
    // A weight of 3 is as good as three samples: the mean is 16^(3/4).
    const ToneMap weighted(Samples{{.luminance = 1.0}, {.luminance = 16.0, .weight = 3.0}});
    EXPECT_NEAR(weighted(glm::dvec3(8.0)).g, 0.18 / 1.18, 1e-6);
}

TEST(ToneMap, HueStaysBelowWhite) {
    const ToneMap map(Samples{{.luminance = 1.0}});
    const glm::vec3 colour = map({0.4, 0.2, 0.1});
    EXPECT_NEAR(colour.r / colour.g, 2.0f, 1e-5f);
    EXPECT_NEAR(colour.g / colour.b, 2.0f, 1e-5f);
}

TEST(ToneMap, OnlyAWhiteShareReachesWhite) {
    const Samples samples = {
        {.luminance = 1.0, .weight = 98.0}, {.luminance = 50.0}, {.luminance = 1000.0}};
    EXPECT_LT(ToneMap(samples)(glm::dvec3(1000.0)).g, 1.0f);
    // A hundredth is brighter than white: the sample of 50 is what becomes white.
    const ToneMap map(samples, {.white_share = 0.01});
    EXPECT_NEAR(map(glm::dvec3(50.0)).g, 1.0f, 1e-6f);
    EXPECT_LT(map(glm::dvec3(20.0)).g, 0.9f);
    EXPECT_EQ(map(glm::dvec3(1000.0)).g, 1.0f);
}

TEST(ToneMap, BlackCountsAsTheFloorOrNotAtAll) {
    const Samples samples = {{.luminance = 0.0}, {.luminance = 1.0}};
    EXPECT_NEAR(ToneMap(samples)(glm::dvec3(1.0)).g, 0.18 / 1.18, 1e-6);
    // Mean of 1e-4 and 1 is 1e-2.
    EXPECT_NEAR(ToneMap(samples, {.floor = 1e-4})(glm::dvec3(1e-2)).g, 0.18 / 1.18, 1e-6);
}

TEST(ToneMap, WithoutLightAllIsBlack) {
    for (const ToneMap& map : {ToneMap(Samples{}), ToneMap(Samples{{.luminance = 0.0}},
                                                           {.floor = 1e-6, .white_share = 0.01})})
        EXPECT_EQ(map(glm::dvec3(0.0)), glm::vec3(0.0f));
}

TEST(ToneMap, WeightsSayWhichColoursAreBright) {
    const cubemap::LuminanceWeights red{1.0, 0.0, 0.0};
    const ToneMap map(Samples{{.luminance = 1.0}}, {.weights = red});
    EXPECT_NEAR(map({1.0, 0.0, 0.0}).r, 0.18 / 1.18, 1e-6);
    EXPECT_NEAR(map({0.0, 1.0, 0.0}).g, 0.18, 1e-6) << "dark, so not compressed";
}

} // namespace
} // namespace relumine::relight
