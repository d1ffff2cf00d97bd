#include "cubemap/doctor/upside_down.h"

#include <gtest/gtest.h>

#include "cubemap/doctor/statistics.h"
#include "cubemap/resample/resample.h"
#include "tests/cubemap/test_images.h"
#include "tests/real_data.h"

namespace relumine::cubemap {
namespace {

TEST(UpsideDown, TheShareFromBelowIsMeasured) {
    for (const std::uint32_t resolution : {1u, 7u, 16u}) {
        CubeMap map(resolution, glm::vec3(1.0f));
        EXPECT_NEAR(light_from_below(map), 0.5, 1e-12) << resolution;
        for (std::uint32_t y = 0; y < resolution; ++y)
            for (std::uint32_t x = 0; x < resolution; ++x)
                map.at(Face::NegativeY, x, y) = glm::vec3(3.0f);
        EXPECT_NEAR(light_from_below(map), (2.0 + 3.0) / 8.0, 0.06 / resolution) << resolution;
    }
    EXPECT_EQ(light_from_below(CubeMap(4)), 0.0);
    EXPECT_FALSE(upside_down(0.5));
    ASSERT_TRUE(upside_down(0.7));
    EXPECT_NE(upside_down(0.7)->find("--flip y"), std::string::npos);
}

TEST(UpsideDown, RealMapsAreDoubtedOnlyWhenTheyAreTurnedOver) {
    for (const std::string file :
         {"debevec/uffizi_latlong_1200.hdr", "latlong/studio_1k.hdr",
          "latlong/blender_studio_1k.exr", "latlong/mitsuba_museum_512.exr",
          "polyhaven/kiara_1_dawn_1k.hdr", "openexr/KernerEnvCube.exr",
          "debevec/stpeters_cross.hdr"}) {
        const auto path = data_file(file);
        if (path.empty())
            GTEST_SKIP() << absent_data("envs");
        const EnvironmentImage image = load_environment(path);
        const CubeMap map = resample(image, 64);
        EXPECT_FALSE(upside_down(light_from_below(map))) << file << ' ' << light_from_below(map);
        EXPECT_TRUE(upside_down(light_from_below(turned(map, {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}}))))
            << file;
        EXPECT_NEAR(statistics(image).light_from_below, light_from_below(map), 1e-3) << file;
    }
}

} // namespace
} // namespace relumine::cubemap
