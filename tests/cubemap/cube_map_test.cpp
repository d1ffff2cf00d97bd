#include "cubemap/cube_map.h"

#include <numbers>
#include <numeric>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

TEST(CubeMap, RefusesResolutionsThatMakeNoSense) {
    EXPECT_THROW(CubeMap(0), std::invalid_argument);
    EXPECT_THROW(CubeMap(16385), std::invalid_argument);
    EXPECT_EQ(CubeMap(3).texels.size(), 54u);
}

TEST(CubeMap, TexelSolidAnglesAreThoseOfTheFace) {
    for (const std::uint32_t resolution : {1u, 2u, 5u, 64u}) {
        const auto angles = texel_solid_angles(resolution);
        const double n = resolution;
        for (std::uint32_t y = 0; y < resolution; ++y) {
            for (std::uint32_t x = 0; x < resolution; ++x)
                ASSERT_NEAR(angles[y * resolution + x] /
                                solid_angle(x / n, y / n, (x + 1) / n, (y + 1) / n),
                            1.0, 1e-12);
        }
    }
}

TEST(CubeMap, SolidAnglesSumToTheSphereAtTheLargestResolutions) {
    const auto angles = texel_solid_angles(4096);
    EXPECT_NEAR(6.0 * std::accumulate(angles.begin(), angles.end(), 0.0) / (4.0 * std::numbers::pi),
                1.0, 1e-10);
}

TEST(CubeMap, ConstantRadianceCausesIrradiancePi) {
    const CubeMap map(64, glm::vec3(2.0f));
    for (const glm::dvec3 normal :
         {glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0), glm::normalize(glm::dvec3(1, 2, 3))})
        EXPECT_NEAR(irradiance(map, normal).x / (2.0 * std::numbers::pi), 1.0, 2e-4);
    EXPECT_NEAR(total_power(map).y / (8.0 * std::numbers::pi), 1.0, 1e-10);
}

TEST(CubeMap, SampleAtTexelCentresIsTheTexel) {
    CubeMap map(5);
    fill_randomly(map.texels, 1);
    for (const Face face : AllFaces) {
        for (std::uint32_t y = 0; y < 5; ++y) {
            for (std::uint32_t x = 0; x < 5; ++x) {
                const glm::vec3 seen = sample(map, glm::vec3(texel_direction(face, x, y, 5)));
                ASSERT_LT(glm::distance(seen, map.at(face, x, y)), 1e-5f);
            }
        }
    }
}

TEST(CubeMap, SampleIsContinuousOverEdgesAndCorners) {
    for (const std::uint32_t resolution : {1u, 2u, 4u, 9u}) {
        CubeMap map(resolution);
        fill_randomly(map.texels, 2);
        for (const Face face : AllFaces) {
            for (int i = 0; i <= 40; ++i) {
                for (const double side : {0.0, 1.0}) {
                    const double inwards = side == 0.0 ? 1e-5 : -1e-5;
                    const auto jump = [&](glm::dvec3 inside, glm::dvec3 outside) {
                        return glm::distance(sample(map, glm::vec3(inside)),
                                             sample(map, glm::vec3(outside)));
                    };
                    EXPECT_LT(jump(cube_point(face, side + inwards, i / 40.0),
                                   cube_point(face, side - inwards, i / 40.0)),
                              2e-3f);
                    EXPECT_LT(jump(cube_point(face, i / 40.0, side + inwards),
                                   cube_point(face, i / 40.0, side - inwards)),
                              2e-3f);
                }
            }
        }
    }
}

} // namespace
} // namespace relumine::cubemap
