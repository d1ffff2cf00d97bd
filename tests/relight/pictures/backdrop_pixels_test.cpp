#include "relight/pictures/backdrop_pixels.h"

#include <algorithm>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "relight/pictures/ground.h"

namespace relumine::relight {
namespace {

using cubemap::EnvironmentImage;

/// Every pixel has a colour of its own, from 0 to 1.
std::shared_ptr<const EnvironmentImage> noise(cubemap::Sampling sampling) {
    EnvironmentImage image;
    image.width = 256;
    image.height = 128;
    image.sampling = sampling;
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform;
    for (std::uint32_t i = 0; i < image.width * image.height; ++i)
        image.pixels.emplace_back(uniform(random), uniform(random), uniform(random));
    return std::make_shared<const EnvironmentImage>(std::move(image));
}

/// Returns the largest difference from the mean of what the samples see one by one.
float largest_difference(const Backdrop& backdrop, const prt::Camera& camera,
                         std::span<const glm::vec3> passed) {
    const PixelRectangle pixels{.right = 48, .bottom = 32};
    const prt::PictureRays grid(camera, pixels.right, pixels.bottom, 3);
    BackdropPixels behind(grid, backdrop, pixels);
    float largest = 0.0f;
    for (std::uint32_t y = 0; y < pixels.bottom; ++y)
        for (std::uint32_t x = 0; x < pixels.right; ++x) {
            glm::vec3 sum(0.0f);
            for (std::uint32_t i = 0; i < 9; ++i)
                sum += passed[i] * backdrop(grid.direction(x, y, i));
            const glm::vec3 difference = behind.seen(x, y, passed) - sum / 9.0f;
            largest = std::max(largest, glm::length(difference));
        }
    return largest;
}

const std::vector<glm::vec3> Open(9, glm::vec3(1.0f));

std::vector<glm::vec3> half_open() {
    std::vector<glm::vec3> passed(9, glm::vec3(0.0f));
    for (std::size_t i = 0; i < 5; ++i)
        passed[i] = {0.25f * static_cast<float>(i), 1.0f, 0.5f};
    return passed;
}

TEST(BackdropPixels, AreTheMeanOfTheirSamples) {
    const prt::Camera level{.eye = {0, 1, 0}, .target = {1, 0.8f, 0.5f}, .fov_degrees = 30};
    for (const auto sampling : {cubemap::Sampling::TexelCentres, cubemap::Sampling::Borders}) {
        const Backdrop backdrop = image_backdrop(noise(sampling));
        ASSERT_NE(backdrop.chart(), nullptr);
        EXPECT_LT(largest_difference(backdrop, level, Open), 0.004f);
        EXPECT_LT(largest_difference(backdrop, level, half_open()), 0.004f);
    }
}

TEST(BackdropPixels, KnowSeamAndPole) {
    const Backdrop backdrop = image_backdrop(noise(cubemap::Sampling::TexelCentres));
    for (const glm::vec3 target : {glm::vec3(0, 0.1f, -1), glm::vec3(0.01f, 1, 0.01f)}) {
        const prt::Camera camera{.eye = {0, 0, 0}, .target = target, .fov_degrees = 20};
        // Pixels whose corners see nearly the same take these for the mean.
        EXPECT_LT(largest_difference(backdrop, camera, Open), 0.02f) << target.y;
    }
}

TEST(BackdropPixels, FollowTheGroundAndTheSweep) {
    const Ground ground{.camera = {0, 1, 0}, .height = 1.0, .reach = 20.0};
    const glm::vec3 eye(0.5f, 1.4f, 2.0f);
    const prt::Camera down{.eye = eye, .target = {0, 0.6f, 0}, .fov_degrees = 35};
    const Backdrop image = image_backdrop(noise(cubemap::Sampling::TexelCentres));
    const Backdrop grounded = grounded_backdrop(image, ground, eye);
    const Backdrop swept = sweep_backdrop(image, {0.2f, 0.5f, 0.9f}, ground, eye);
    for (const Backdrop& backdrop : {grounded, swept}) {
        ASSERT_NE(backdrop.chart(), nullptr);
        // Where the places bend, corners that see nearly the same are taken for the mean.
        EXPECT_LT(largest_difference(backdrop, down, Open), 0.02f);
        EXPECT_LT(largest_difference(backdrop, down, half_open()), 0.006f);
    }
    const glm::vec3 w = glm::normalize(glm::vec3(0.1f, -0.3f, -1.0f));
    const Backdrop plain = [&](const glm::vec3& direction) {
        return image(direction);
    };
    EXPECT_EQ(grounded_backdrop(plain, ground, eye)(w), grounded(w));
    EXPECT_LT(glm::length(sweep_backdrop(plain, {0.2f, 0.5f, 0.9f}, ground, eye)(w) - swept(w)),
              1e-6f);
}

} // namespace
} // namespace relumine::relight
