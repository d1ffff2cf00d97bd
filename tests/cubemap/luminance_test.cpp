#include "cubemap/luminance.h"

#include <gtest/gtest.h>

namespace relumine::cubemap {
namespace {

TEST(Luminance, WeightsAddUpToOne) {
    for (const LuminanceWeights& weights : {Rec709Weights, MedianCutWeights})
        EXPECT_DOUBLE_EQ(luminance(glm::dvec3(1.0), weights), 1.0);
}

TEST(Luminance, EachChannelHasItsWeight) {
    EXPECT_EQ(luminance({1.0, 0.0, 0.0}), 0.2126);
    EXPECT_EQ(luminance({0.0, 1.0, 0.0}), 0.7152);
    EXPECT_EQ(luminance({0.0, 0.0, 1.0}), 0.0722);
    EXPECT_EQ(luminance({0.0, 1.0, 0.0}, MedianCutWeights), 0.7154);
}

TEST(Luminance, OfVectorsIsTheLuminanceOfEveryComponent) {
    const glm::dvec3 red(1.0, 2.0, 3.0), green(-4.0, 5.0, 0.5), blue(0.1, 0.0, 7.0);
    const glm::dvec3 all = luminance(red, green, blue);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_EQ(all[axis], luminance({red[axis], green[axis], blue[axis]}));
}

} // namespace
} // namespace relumine::cubemap
