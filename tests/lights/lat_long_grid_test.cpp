#include "lights/lat_long_grid.h"

#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "lights/summed_area_table.h"
#include "tests/lights/test_maps.h"

namespace relumine::lights {
namespace {

/// The direction of a point of a lat-long: centre +Z, +X left of it, top +Y.
glm::dvec3 direction(double u, double v) {
    const double longitude = std::numbers::pi - 2.0 * std::numbers::pi * u;
    return {std::sin(std::numbers::pi * v) * std::sin(longitude), std::cos(std::numbers::pi * v),
            std::sin(std::numbers::pi * v) * std::cos(longitude)};
}

TEST(LatLongGrid, MomentsAreTheIntegralsOverThePixel) {
    for (const auto sampling : {cubemap::Sampling::TexelCentres, cubemap::Sampling::Borders}) {
        auto image = constant(7, 5, glm::vec3(1.0f));
        image.sampling = sampling;
        const LatLongGrid grid(image);
        const auto across = cubemap::cell_borders(7, sampling);
        const auto down = cubemap::cell_borders(5, sampling);
        for (std::uint32_t y = 0; y < 5; ++y)
            for (std::uint32_t x = 0; x < 7; ++x) {
                constexpr int Steps = 100;
                glm::dvec4 sum(0.0);
                for (int j = 0; j < Steps; ++j)
                    for (int i = 0; i < Steps; ++i) {
                        const double u =
                            across[x] + (across[x + 1] - across[x]) * (i + 0.5) / Steps;
                        const double v = down[y] + (down[y + 1] - down[y]) * (j + 0.5) / Steps;
                        sum += std::sin(std::numbers::pi * v) * glm::dvec4(direction(u, v), 1.0);
                    }
                sum *= 2.0 * std::numbers::pi * std::numbers::pi * (across[x + 1] - across[x]) *
                       (down[y + 1] - down[y]) / (Steps * Steps);
                const glm::dvec4 moments = grid.moments(x, y);
                for (int i = 0; i < 4; ++i)
                    EXPECT_NEAR(moments[i], sum[i], 1e-4) << x << "," << y << "," << i;
                EXPECT_EQ(grid.solid_angle(x, y), moments.w);
                EXPECT_NEAR(grid.solid_angle({x, y, x + 1, y + 1}), moments.w, 1e-14);
            }
    }
}

TEST(LatLongGrid, KnowsTheExtentOfRegions) {
    const auto image = constant(8, 4, glm::vec3(1.0f));
    const LatLongGrid grid(image);
    EXPECT_NEAR(grid.solid_angle(grid.whole()), 4.0 * std::numbers::pi, 1e-12);
    EXPECT_NEAR(grid.angular_width(grid.whole()), 2.0 * std::numbers::pi, 1e-12);
    EXPECT_NEAR(grid.angular_height(grid.whole()), std::numbers::pi, 1e-12);
    // The upper half: its centre is inclined by 45 degrees.
    EXPECT_NEAR(grid.angular_width({0, 0, 8, 2}), 2.0 * std::numbers::pi * std::sqrt(0.5), 1e-12);
    EXPECT_NEAR(glm::distance(grid.centre({2, 1, 6, 3}), glm::dvec3(0, 0, 1)), 0.0, 1e-12);
    EXPECT_NEAR(glm::distance(grid.centre({0, 1, 4, 3}), glm::dvec3(1, 0, 0)), 0.0, 1e-12);
    EXPECT_NEAR(glm::distance(grid.direction(4, 2, 0.0, 0.0), glm::dvec3(0, 0, 1)), 0.0, 1e-12);
    EXPECT_NEAR(grid.direction(0, 0, 0.5, 0.0).y, 1.0, 1e-12);
}

TEST(SummedAreaTable, SumsRectangles) {
    const auto image = wild(70, 33);
    const LatLongGrid grid(image);
    const SummedAreaTable<double> table(70, 33, [&](std::uint32_t y, double* row) {
        for (std::uint32_t x = 0; x < 70; ++x)
            row[x] = grid.energy(x, y);
    });
    double whole = 0.0;
    for (const PixelRectangle& region :
         {PixelRectangle{0, 0, 70, 33}, PixelRectangle{3, 4, 4, 5}, PixelRectangle{69, 32, 70, 33},
          PixelRectangle{10, 0, 60, 20}}) {
        double expected = 0.0;
        for (std::uint32_t y = region.y0; y < region.y1; ++y)
            for (std::uint32_t x = region.x0; x < region.x1; ++x)
                expected +=
                    luminance(glm::dvec3(image.pixels[y * 70 + x])) * grid.solid_angle(x, y);
        whole = std::max(whole, expected);
        EXPECT_NEAR(table.sum(region), expected, 1e-13 * whole);
    }
    EXPECT_EQ(table.sum({5, 5, 5, 9}), 0.0);
}

TEST(LatLongGrid, LuminanceHasTheWeightsOfThePaper) {
    EXPECT_DOUBLE_EQ(luminance({1.0, 10.0, 100.0}), 0.2125 + 7.154 + 7.21);
}

} // namespace
} // namespace relumine::lights
