#include "relight/light_pyramid.h"

#include <gtest/gtest.h>

#include "tests/relight/environments.h"

namespace relumine::relight {
namespace {

glm::dvec3 light_of(const LightPyramid& pyramid, const prt::Cell& cell) {
    const float* light = pyramid.light().data() + std::size_t{3} * prt::cell_index(cell);
    return {light[0], light[1], light[2]};
}

glm::dvec3 total(const cubemap::CubeMap& map) {
    const std::vector<double> solid_angles = cubemap::texel_solid_angles(map.resolution);
    glm::dvec3 sum(0.0);
    for (std::size_t i = 0; i < map.texels.size(); ++i)
        sum += glm::dvec3(map.texels[i]) * solid_angles[i % solid_angles.size()];
    return sum;
}

TEST(LightPyramid, HoldsAllLightAtEveryLevel) {
    for (const std::uint32_t resolution :
         {1u, 4u, 6u, 16u, 40u}) { // coarser than the cells, finer, no power of two
        const cubemap::CubeMap map = scenes::random_environment(resolution, 3);
        LightPyramid pyramid(4);
        pyramid.set(map, LightBinning(resolution), {});
        const glm::dvec3 expected = total(map);
        for (std::uint8_t level = 0; level <= 4; ++level) {
            glm::dvec3 sum(0.0);
            for (const cubemap::Face face : cubemap::AllFaces)
                for (std::uint32_t y = 0; y < 1u << level; ++y)
                    for (std::uint32_t x = 0; x < 1u << level; ++x)
                        sum += light_of(pyramid, {face, level, x, y});
            // Where texels do not fit, a cell's light is taken for the length of its vector: it is
            // 4 degrees wide here.
            EXPECT_LT(glm::length(sum - expected),
                      (resolution == 6 || resolution == 40 ? 1e-3 : 1e-5) * glm::length(expected))
                << resolution << " level " << int{level};
        }
    }
}

TEST(LightPyramid, ACellHasTheLightOfItsTexels) {
    const cubemap::CubeMap map = scenes::random_environment(16, 5);
    LightPyramid pyramid(3);
    pyramid.set(map, LightBinning(16), {});
    const prt::Cell cell{cubemap::Face::NegativeY, 2, 1, 3};
    const std::vector<double> solid_angles = cubemap::texel_solid_angles(16);
    glm::dvec3 expected(0.0);
    for (std::uint32_t y = 12; y < 16; ++y)
        for (std::uint32_t x = 4; x < 8; ++x)
            expected += glm::dvec3(map.at(cell.face, x, y)) * solid_angles[y * 16 + x];
    EXPECT_LT(glm::length(light_of(pyramid, cell) - expected), 1e-6 * glm::length(expected));
}

TEST(LightPyramid, LeavesSharpLightsOut) {
    cubemap::CubeMap map(16);
    map.at(cubemap::Face::PositiveZ, 5, 9) = glm::vec3(100.0f);
    map.at(cubemap::Face::PositiveX, 2, 2) = glm::vec3(1.0f);
    const LightBinning binning(16);
    for (const std::uint8_t level :
         {std::uint8_t{2}, std::uint8_t{4}}) { // coarser and finer than the deepest cells
        const prt::Cell cell{cubemap::Face::PositiveZ, level, 5u >> (4u - level),
                             9u >> (4u - level)};
        const SharpLight sharp{
            .cell = cell, .direction = {0, 0, 1}, .irradiance = binning.sum(map, cell)};
        LightPyramid pyramid(3);
        pyramid.set(map, binning, {&sharp, 1});
        EXPECT_NEAR(light_of(pyramid, {cubemap::Face::PositiveZ, 0, 0, 0}).r, 0.0, 1e-6);
        EXPECT_GT(light_of(pyramid, {cubemap::Face::PositiveX, 0, 0, 0}).r, 0.0);
    }
}

TEST(LightPyramid, DistantLightsGoToTheirCells) {
    LightPyramid pyramid(5);
    const lights::DistantLight light{.direction = glm::normalize(glm::dvec3(0.2, 0.9, 0.3)),
                                     .irradiance = {3, 2, 1}};
    pyramid.set_lights({&light, 1});
    EXPECT_EQ(light_of(pyramid, {cubemap::Face::PositiveY, 0, 0, 0}), glm::dvec3(3, 2, 1));
    const cubemap::FacePoint point = cubemap::face_point(light.direction);
    EXPECT_EQ(
        light_of(pyramid, {cubemap::Face::PositiveY, 5, static_cast<std::uint32_t>(point.s * 32),
                           static_cast<std::uint32_t>(point.t * 32)}),
        glm::dvec3(3, 2, 1));
    pyramid.set_lights({});
    EXPECT_EQ(light_of(pyramid, {cubemap::Face::PositiveY, 0, 0, 0}), glm::dvec3(0.0));
}

} // namespace
} // namespace relumine::relight
