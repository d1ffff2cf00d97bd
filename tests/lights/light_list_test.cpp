#include "lights/light_list.h"

#include <gtest/gtest.h>

namespace relumine::lights {
namespace {

TEST(LightList, TotalIrradianceAddsChannelByChannel) {
    const std::vector<DistantLight> lights = {{.irradiance = {1.0, 2.0, 3.0}},
                                              {.irradiance = {0.5, 0.0, 4.0}}};
    EXPECT_EQ(total_irradiance(lights), glm::dvec3(1.5, 2.0, 7.0));
    EXPECT_EQ(total_irradiance(std::vector<DistantLight>{}), glm::dvec3(0.0));
}

} // namespace
} // namespace relumine::lights
