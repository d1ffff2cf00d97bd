#include "mesh/materials/mip_maps.h"

#include <cmath>

#include <gtest/gtest.h>

namespace relumine::mesh {
namespace {

/// Columns of white and black, one texel wide.
std::vector<Texture> stripes(std::uint32_t width, std::uint32_t height) {
    std::vector<Texture> textures(1);
    textures[0].width = width;
    textures[0].height = height;
    for (std::uint32_t i = 0; i < width * height; ++i)
        textures[0].texels.push_back(i % width % 2 == 0 ? std::array<std::uint8_t, 3>{255, 255, 255}
                                                        : std::array<std::uint8_t, 3>{0, 0, 0});
    return textures;
}

TEST(MipMaps, WithinATexelAreTheTexture) {
    const std::vector<Texture> textures = stripes(8, 4);
    const MipMaps maps(textures);
    const TextureSlot slot{.is_srgb = true};
    for (int i = 0; i < 20; ++i) {
        const glm::vec2 uv(0.07f * static_cast<float>(i), 0.3f);
        EXPECT_EQ(maps.sample(slot, uv, {}), sample(textures[0], slot, uv));
        EXPECT_EQ(maps.sample(slot, uv, {.right = {0.12f, 0}, .down = {0, 0.2f}}),
                  sample(textures[0], slot, uv));
    }
}

/// Light is the mean, not the byte.
TEST(MipMaps, WideFootprintsSeeTheMeanOfTheLight) {
    for (const std::uint32_t width : {64u, 1u << 9u}) {
        const std::vector<Texture> textures = stripes(width, 16);
        const MipMaps maps(textures);
        for (const bool is_srgb : {false, true})
            for (int i = 0; i < 20; ++i) {
                const glm::vec3 value =
                    maps.sample({.is_srgb = is_srgb}, {0.05f * static_cast<float>(i), 0.5f},
                                {.right = {0.25f, 0}, .down = {0, 0.25f}});
                EXPECT_NEAR(value.g, 0.5f, 0.01f);
            }
    }
}

TEST(MipMaps, LongFootprintsAreSharpAcross) {
    const std::vector<Texture> textures = stripes(64, 64);
    const MipMaps maps(textures);
    for (std::uint32_t i = 0; i < 8; ++i) {
        const glm::vec2 middle((static_cast<float>(i) + 0.5f) / 64.0f, 0.5f);
        const glm::vec2 narrow(0.5f / 64.0f, 0), wide(0, 12.0f / 64.0f);
        EXPECT_NEAR(maps.sample({}, middle, {.right = narrow, .down = wide}).r,
                    i % 2 == 0 ? 1.0f : 0.0f, 0.01f);
        EXPECT_NEAR(maps.sample({}, middle, {.right = wide, .down = narrow}).r,
                    i % 2 == 0 ? 1.0f : 0.0f, 0.01f);
        // Across the stripes: even within the light of several looks.
        const glm::vec2 across(12.0f / 64.0f, 0), along(0, 0.5f / 64.0f);
        EXPECT_NEAR(maps.sample({}, middle, {.right = across, .down = along}).r, 0.5f, 0.1f);
    }
}

/// Odd sizes lose no light and do not drift: a bright column stays where it is.
TEST(MipMaps, OddSizes) {
    std::vector<Texture> textures(1);
    textures[0].width = 37;
    textures[0].height = 5;
    textures[0].texels.assign(std::size_t{37} * 5, {0, 0, 0});
    for (std::size_t row = 0; row < 5; ++row)
        for (std::size_t column = 27; column < 37; ++column)
            textures[0].texels[row * 37 + column] = {255, 255, 255};
    const MipMaps maps(textures);
    const TextureSlot slot{.wrap = {Wrap::Clamp, Wrap::Clamp}};
    double sum = 0.0, moment = 0.0;
    constexpr int Steps = 400;
    for (int i = 0; i < Steps; ++i) {
        const float u = (static_cast<float>(i) + 0.5f) / Steps;
        const float value =
            maps.sample(slot, {u, 0.5f}, {.right = {4.0f / 37, 0}, .down = {0, 4.0f / 5}}).r;
        sum += double{value} / Steps;
        moment += double{u * value} / Steps;
    }
    EXPECT_NEAR(sum, 10.0 / 37.0, 0.02);
    EXPECT_NEAR(moment / sum, 32.0 / 37.0, 0.02);
}

TEST(MipMaps, FootprintsThatAreNotFiniteAreNone) {
    const std::vector<Texture> textures = stripes(1, 1);
    const MipMaps maps(textures);
    for (const float bad : {NAN, INFINITY})
        EXPECT_EQ(maps.sample({}, {0.5f, 0.5f}, {.right = {bad, 0}}).r, 1.0f);
    EXPECT_EQ(maps.sample({}, {0.5f, 0.5f}, {.right = {9, 0}, .down = {0, 9}}).r, 1.0f)
        << "a texture of one pixel";
}

} // namespace
} // namespace relumine::mesh
