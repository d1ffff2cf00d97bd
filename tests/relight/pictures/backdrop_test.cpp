#include "relight/pictures/backdrop.h"

#include <cmath>
#include <numbers>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "cubemap/resample/resample.h"
#include "tests/prt/scenes.h"
#include "tests/relight/environments.h"

namespace relumine::relight {
namespace {

using cubemap::Layout;

std::shared_ptr<const cubemap::EnvironmentImage> image_of(const cubemap::CubeMap& map,
                                                          Layout layout) {
    const cubemap::ImageSize size = cubemap::natural_size(layout, map.resolution);
    return std::make_shared<const cubemap::EnvironmentImage>(
        cubemap::to_image(map, layout, size.width, size.height));
}

TEST(Backdrop, OfAnImageOfAnyLayoutShowsTheSphereTheRightWay) {
    const cubemap::CubeMap map = scenes::smooth_environment(64);
    std::mt19937 random(5);
    for (const Layout layout : cubemap::AllLayouts) {
        const Backdrop backdrop = image_backdrop(image_of(map, layout));
        double error = 0.0, sum = 0.0;
        for (int i = 0; i < 1000; ++i) {
            const glm::vec3 w = scenes::random_direction(random);
            error += std::pow(
                static_cast<double>(glm::length(backdrop(w) - cubemap::sample(map, w))), 2);
            sum += std::pow(static_cast<double>(glm::length(cubemap::sample(map, w))), 2);
        }
        EXPECT_LT(std::sqrt(error / sum), 0.02) << name(layout);
    }
}

TEST(Backdrop, OfAnImageIsAsSharpAsItsPixels) {
    // Columns black and white in turn: their middles are black and white.
    cubemap::EnvironmentImage image;
    image.width = 512;
    image.height = 256;
    for (std::uint32_t y = 0; y < 256; ++y)
        for (std::uint32_t x = 0; x < 512; ++x)
            image.pixels.emplace_back(static_cast<float>(x % 2));
    const Backdrop backdrop =
        image_backdrop(std::make_shared<const cubemap::EnvironmentImage>(image));
    for (std::uint32_t x = 0; x < 512; ++x) {
        const double longitude = 2.0 * std::numbers::pi * (0.5 - (x + 0.5) / 512.0);
        const glm::vec3 w(std::sin(longitude), 0.0, std::cos(longitude));
        EXPECT_NEAR(backdrop(w).r, static_cast<float>(x % 2), 1e-3f) << x;
    }
}

TEST(Backdrop, OfAnImageTurnsWithTheEnvironment) {
    const cubemap::CubeMap map = scenes::smooth_environment(64);
    std::mt19937 random(6);
    for (const double degrees : {90.0, 33.0}) {
        const cubemap::CubeMap turned = cubemap::rotated(map, degrees);
        for (const Layout layout : {Layout::LatLong, Layout::VerticalCross}) {
            const Backdrop backdrop =
                image_backdrop(image_of(map, layout), cubemap::turn_about_y(degrees));
            for (int i = 0; i < 200; ++i) {
                const glm::vec3 w = scenes::random_direction(random);
                EXPECT_LT(glm::length(backdrop(w) - cubemap::sample(turned, w)), 0.1f);
            }
        }
    }
}

TEST(Backdrop, OfAnEditIsSharpWhereNothingWasEdited) {
    const cubemap::CubeMap base(4, glm::vec3(1.0f));
    cubemap::CubeMap edited = base;
    for (std::uint32_t i = 0; i < 16; ++i) {
        edited.at(cubemap::Face::PositiveX, i % 4, i / 4) = glm::vec3(0.25f);
        edited.at(cubemap::Face::NegativeX, i % 4, i / 4) = glm::vec3(5.0f);
    }
    const Backdrop sharp = plain_backdrop({2.0f, 0.5f, 0.0f});
    const Backdrop backdrop = edited_backdrop(sharp, base, edited);
    EXPECT_EQ(backdrop({0, 0, 1}), glm::vec3(2.0f, 0.5f, 0.0f));
    EXPECT_EQ(backdrop({1, 0, 0}), glm::vec3(0.5f, 0.125f, 0.0f));
    EXPECT_EQ(backdrop({-1, 0, 0}), glm::vec3(6.0f, 4.5f, 4.0f));
}

TEST(Backdrop, BlurKeepsTheLightAndIsAsWideAsAsked) {
    EXPECT_LT(
        glm::distance(blurred_backdrop(cubemap::CubeMap(16, glm::vec3(3.0f)), 20.0)({0, 1, 0}),
                      glm::vec3(3.0f)),
        1e-4f);
    // A lamp of a degree becomes a spot that is half as bright at half the width.
    cubemap::CubeMap map(256);
    map.at(cubemap::Face::PositiveZ, 127, 127) = map.at(cubemap::Face::PositiveZ, 128, 128) =
        map.at(cubemap::Face::PositiveZ, 127, 128) = map.at(cubemap::Face::PositiveZ, 128, 127) =
            glm::vec3(1000.0f);
    for (const double degrees : {10.0, 40.0}) {
        const Backdrop blurred = blurred_backdrop(map, degrees);
        const double half = 0.5 * degrees * std::numbers::pi / 180.0;
        const float middle = blurred({0, 0, 1}).r;
        for (int i = 0; i < 8; ++i) {
            const double turn = i * std::numbers::pi / 4.0;
            const glm::vec3 w(std::sin(half) * std::cos(turn), std::sin(half) * std::sin(turn),
                              std::cos(half));
            EXPECT_NEAR(blurred(w).r / middle, 0.5f, 0.12f) << degrees << ' ' << i;
        }
    }
    EXPECT_THROW(static_cast<void>(blurred_backdrop(map, 0.0)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(blurred_backdrop({}, 5.0)), std::invalid_argument);
}

} // namespace
} // namespace relumine::relight
