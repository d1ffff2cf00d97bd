#include "relight/pictures/exposure.h"

#include <vector>

#include <gtest/gtest.h>

namespace relumine::relight {
namespace {

TEST(SuitableExposure, LeavesWhatIsFineAndLiftsWhatIsDark) {
    EXPECT_EQ(suitable_exposure_ev(std::vector(100, glm::vec3(0.9f))), 0.0f);
    EXPECT_EQ(suitable_exposure_ev(std::vector(100, glm::vec3(1.0f / 64.0f))), 6.0f);
    EXPECT_EQ(suitable_exposure_ev(std::vector(100, glm::vec3(256.0f))), -8.0f);
    EXPECT_EQ(suitable_exposure_ev(std::vector(100, glm::vec3(0.0f))), 0.0f);
    EXPECT_EQ(suitable_exposure_ev({}), 0.0f);
}

} // namespace
} // namespace relumine::relight
