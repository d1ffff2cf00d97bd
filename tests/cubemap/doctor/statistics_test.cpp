#include "cubemap/doctor/statistics.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

TEST(Statistics, ConstantEnvironment) {
    for (const Layout layout : {Layout::LatLong, Layout::Cube, Layout::VerticalCross}) {
        EnvironmentImage image = black_image(layout, Sampling::TexelCentres, 16);
        paint(image, [](const glm::dvec3&) { return glm::vec3(1.0f, 2.0f, 4.0f); });
        const EnvironmentStatistics result = statistics(image);
        EXPECT_NEAR(result.mean_radiance.x, 1.0, 1e-9);
        EXPECT_NEAR(result.mean_radiance.z, 4.0, 1e-9);
        EXPECT_NEAR(result.mean_luminance, 0.2126 + 2.0 * 0.7152 + 4.0 * 0.0722, 1e-9);
        EXPECT_NEAR(result.dynamic_range_ev, 0.0, 1e-9);
    }
}

TEST(Statistics, BrightestPixelAndRange) {
    EnvironmentImage image = black_image(Layout::LatLong, Sampling::Borders, 33);
    paint(image, [](const glm::dvec3& w) { return glm::vec3(w.x > 0.0 ? 0.5f : 0.0f); });
    glm::dvec3 expected(0.0);
    for_each_pixel(shape_of(image), [&](std::size_t index, const PixelPlace& place) {
        if (index == 500) {
            image.pixels[index] = glm::vec3(64.0f);
            expected = place.direction;
        }
    });
    const EnvironmentStatistics result = statistics(image);
    EXPECT_EQ(result.brightest_direction, expected);
    EXPECT_NEAR(result.max_luminance, 64.0, 1e-9);
    EXPECT_NEAR(result.min_positive_luminance, 0.5, 1e-9);
    EXPECT_NEAR(result.dynamic_range_ev, 7.0, 1e-9);
}

TEST(Statistics, IrradianceOfAConstantAndOfOneSide) {
    for (const Layout layout : {Layout::LatLong, Layout::Cube, Layout::VerticalCross}) {
        EnvironmentImage image = black_image(layout, Sampling::TexelCentres, 128);
        paint(image, [](const glm::dvec3&) { return glm::vec3(1.0f, 2.0f, 0.0f); });
        for (const glm::dvec3& irradiance : statistics(image).axis_irradiance) {
            EXPECT_NEAR(irradiance.x, 3.14159265, 1e-3);
            EXPECT_NEAR(irradiance.y, 2.0 * 3.14159265, 2e-3);
            EXPECT_EQ(irradiance.z, 0.0);
        }
        // Light from x > 0 only: pi on +X, half of it on the sides.
        paint(image, [](const glm::dvec3& w) { return glm::vec3(w.x > 0.0 ? 1.0f : 0.0f); });
        const auto irradiance = statistics(image).axis_irradiance;
        EXPECT_NEAR(irradiance[0].x, 3.14159265, 1e-3);
        EXPECT_EQ(irradiance[1].x, 0.0);
        for (std::size_t side = 2; side < 6; ++side)
            EXPECT_NEAR(irradiance[side].x, 0.5 * 3.14159265, 1e-3);
    }
}

TEST(Statistics, LeavesBadPixelsOut) {
    EnvironmentImage image = black_image(Layout::Cube, Sampling::TexelCentres, 8);
    image.pixels.assign(image.pixels.size(), glm::vec3(1.0f));
    image.pixels[10].x = std::numeric_limits<float>::quiet_NaN();
    image.pixels[20].y = std::numeric_limits<float>::infinity();
    image.pixels[30].z = -1.0f;
    const EnvironmentStatistics result = statistics(image);
    EXPECT_NEAR(result.mean_radiance.x, 1.0, 1e-9);
    EXPECT_NEAR(result.max_luminance, 1.0, 1e-9);
}

TEST(Statistics, BlackEnvironment) {
    const EnvironmentStatistics result =
        statistics(black_image(Layout::LatLong, Sampling::TexelCentres, 8));
    EXPECT_EQ(result.max_luminance, 0.0);
    EXPECT_EQ(result.min_positive_luminance, 0.0);
    EXPECT_EQ(result.dynamic_range_ev, 0.0);
}

} // namespace
} // namespace relumine::cubemap
