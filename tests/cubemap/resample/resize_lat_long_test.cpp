#include "cubemap/resample/resize_lat_long.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include "cubemap/cube_map.h"
#include "files/parallel.h"
#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

constexpr double Pi = std::numbers::pi;

EnvironmentImage noise(std::uint32_t width, std::uint32_t height, Sampling sampling,
                       std::uint32_t seed) {
    EnvironmentImage image = black_image(Layout::LatLong, sampling, width, height);
    fill_randomly(image.pixels, seed);
    return image;
}

EnvironmentImage resized(const EnvironmentImage& image, const ImageShape& target,
                         const glm::dmat3& turn) {
    EnvironmentImage result =
        black_image(target.layout, target.sampling, target.width, target.height);
    LatLongResize(shape_of(image), target, turn).average(image.pixels, result.pixels);
    return result;
}

/// The plain way: points spread evenly over each target pixel's part of the sphere look up the
/// source pixel that they lie in.
std::vector<glm::dvec3> means_of_points(const EnvironmentImage& image, const ImageShape& target,
                                        const glm::dmat3& target_from_source, int num_points) {
    const glm::dmat3 source_from_target = glm::transpose(target_from_source);
    const auto columns = cell_borders(image.width, image.sampling),
               rows = cell_borders(image.height, image.sampling);
    const auto target_columns = cell_borders(target.width, target.sampling),
               target_rows = cell_borders(target.height, target.sampling);
    const auto cell = [](const std::vector<double>& borders, double place) {
        const auto after = std::upper_bound(borders.begin(), borders.end(), place);
        return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
            after - borders.begin() - 1, 0, static_cast<std::ptrdiff_t>(borders.size()) - 2));
    };
    std::vector<glm::dvec3> means;
    for (std::uint32_t y = 0; y < target.height; ++y)
        for (std::uint32_t x = 0; x < target.width; ++x) {
            glm::dvec3 sum(0.0);
            for (int i = 0; i < num_points; ++i)
                for (int j = 0; j < num_points; ++j) {
                    const double across = (i + 0.5) / num_points, down = (j + 0.5) / num_points;
                    const double u = std::lerp(target_columns[x], target_columns[x + 1], across);
                    const double height = std::lerp(std::cos(Pi * target_rows[y]),
                                                    std::cos(Pi * target_rows[y + 1]), down);
                    const double radius = std::sqrt(1.0 - height * height);
                    const double longitude = 2.0 * Pi * (0.5 - u);
                    const glm::dvec3 w =
                        source_from_target * glm::dvec3(radius * std::sin(longitude), height,
                                                        radius * std::cos(longitude));
                    const double from = 0.5 - std::atan2(w.x, w.z) / (2.0 * Pi);
                    const double polar = std::acos(std::clamp(w.y, -1.0, 1.0)) / Pi;
                    sum += glm::dvec3(
                        image.pixels[cell(rows, polar) * image.width + cell(columns, from)]);
                }
            means.push_back(sum / static_cast<double>(num_points * num_points));
        }
    return means;
}

TEST(ResizeLatLong, EachPixelIsTheMeanOverItsFootprint) {
    const glm::dmat3 mirrored(-1, 0, 0, 0, 1, 0, 0, 0, 1), turned_over(1, 0, 0, 0, -1, 0, 0, 0, 1);
    const std::vector<glm::dmat3> turns = {glm::dmat3(1.0), turn_about_y(37.0),
                                           turn_about_y(-100.0) * mirrored,
                                           turned_over * turn_about_y(200.0)};
    for (const Sampling sampling : {Sampling::TexelCentres, Sampling::Borders})
        for (const ImageSize size : {ImageSize{7, 5}, ImageSize{31, 18}})
            for (const glm::dmat3& turn : turns) {
                const EnvironmentImage image = noise(16, 9, sampling, 3);
                const ImageShape target{Layout::LatLong, Sampling::TexelCentres, size.width,
                                        size.height};
                const EnvironmentImage result = resized(image, target, turn);
                const auto expected = means_of_points(image, target, turn, 40);
                ASSERT_EQ(result.pixels.size(), expected.size());
                for (std::size_t i = 0; i < expected.size(); ++i)
                    EXPECT_NEAR(result.pixels[i].y, expected[i].y, 0.03) << i;
                // Means keep the power exactly.
                EXPECT_NEAR(total_power(result).y / total_power(image).y, 1.0, 1e-6);
            }
}

TEST(ResizeLatLong, HalvesOfPixelsAreThePixels) {
    const EnvironmentImage image = noise(12, 6, Sampling::TexelCentres, 4);
    const ImageShape twice{Layout::LatLong, Sampling::TexelCentres, 24, 12};
    const EnvironmentImage fine = resized(image, twice, glm::dmat3(1.0));
    for (std::uint32_t y = 0; y < 12; ++y)
        for (std::uint32_t x = 0; x < 24; ++x)
            EXPECT_NEAR(fine.pixels[y * 24 + x].x, image.pixels[y / 2 * 12 + x / 2].x, 1e-6f);
}

TEST(ResizeLatLong, KnowsWhichTurnsKeepTheVertical) {
    EXPECT_TRUE(keeps_vertical(turn_about_y(12.0)));
    EXPECT_TRUE(keeps_vertical(turn_about_x(180.0)));
    EXPECT_FALSE(keeps_vertical(turn_about_x(1.0)));
    EXPECT_FALSE(keeps_vertical(turn_about_x(90.0)));
}

TEST(ResizeLatLong, IsTheSameForAnyNumberOfThreads) {
    const EnvironmentImage image = noise(40, 20, Sampling::TexelCentres, 5);
    const ImageShape target{Layout::LatLong, Sampling::TexelCentres, 77, 33};
    const auto many = resized(image, target, turn_about_y(5.0)).pixels;
    const files::ThreadLimit one(1);
    EXPECT_EQ(resized(image, target, turn_about_y(5.0)).pixels, many);
}

} // namespace
} // namespace relumine::cubemap
