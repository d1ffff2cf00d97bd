#include "cubemap/image/image_layout.h"

#include <numbers>

#include <ImfEnvmap.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

TEST(ImageLayout, CellBordersOfBothSamplings) {
    EXPECT_EQ(cell_borders(4, Sampling::TexelCentres),
              (std::vector<double>{0.0, 0.25, 0.5, 0.75, 1.0}));
    EXPECT_EQ(cell_borders(3, Sampling::Borders), (std::vector<double>{0.0, 0.25, 0.75, 1.0}));
    EXPECT_EQ(cell_borders(2, Sampling::Borders), (std::vector<double>{0.0, 0.5, 1.0}));
    EXPECT_EQ(cell_borders(1, Sampling::Borders), (std::vector<double>{0.0, 1.0}));
    EXPECT_EQ(sample_position(0, 3, Sampling::Borders), 0.0);
    EXPECT_EQ(sample_position(2, 3, Sampling::Borders), 1.0);
    EXPECT_EQ(sample_position(0, 1, Sampling::Borders), 0.5);
}

TEST(ImageLayout, PixelsOfEveryLayoutTileTheSphere) {
    for (const Layout layout : {Layout::LatLong, Layout::Cube, Layout::VerticalCross}) {
        for (const Sampling sampling : {Sampling::TexelCentres, Sampling::Borders}) {
            for (const std::uint32_t size : {1u, 2u, 3u, 16u, 50u}) {
                const EnvironmentImage image = black_image(layout, sampling, size);
                double sum = 0.0;
                for_each_pixel(shape_of(image), [&](std::size_t index, const PixelPlace& place) {
                    ASSERT_LT(index, image.pixels.size());
                    ASSERT_NEAR(glm::length(place.direction), 1.0, 1e-14);
                    sum += place.solid_angle;
                });
                EXPECT_NEAR(sum / (4.0 * std::numbers::pi), 1.0, 1e-10)
                    << name(layout) << " " << size;
            }
        }
    }
}

TEST(ImageLayout, LatLongSamplesOnBordersAgreeWithOpenExr) {
    const EnvironmentImage image = black_image(Layout::LatLong, Sampling::Borders, 32);
    const Imath::Box2i window({0, 0}, {63, 31});
    for_each_pixel(shape_of(image), [&](std::size_t index, const PixelPlace& place) {
        const Imath::V2f pixel(static_cast<float>(index % 64), static_cast<float>(index / 64));
        const Imath::V3f theirs = Imf::LatLongMap::direction(window, pixel);
        ASSERT_NEAR(glm::distance(place.direction, glm::dvec3(theirs.x, theirs.y, theirs.z)), 0.0,
                    1e-6);
    });
}

TEST(ImageLayout, LatLongLooksAtPositiveZWithPositiveXOnTheLeft) {
    const EnvironmentImage image = black_image(Layout::LatLong, Sampling::TexelCentres, 512);
    for_each_pixel(shape_of(image), [&](std::size_t index, const PixelPlace& place) {
        const std::size_t x = index % 1024, y = index / 1024;
        if (x == 512 && y == 256) {
            EXPECT_GT(place.direction.z, 0.999);
        }
        if (x == 256 && y == 256) {
            EXPECT_GT(place.direction.x, 0.999);
        }
        if (y == 0) {
            EXPECT_GT(place.direction.y, 0.999);
        }
    });
}

/// The table that was measured against angular-map probes of the same places: cell (row, column),
/// direction, image right, image up.
TEST(ImageLayout, CrossCellsLieAsMeasured) {
    struct Cell {
        std::size_t row, column;
        glm::dvec3 direction, right, up;
    };
    const std::array<Cell, 6> table = {Cell{0, 1, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
                                       Cell{1, 0, {-1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
                                       Cell{1, 1, {0, 0, -1}, {1, 0, 0}, {0, 1, 0}},
                                       Cell{1, 2, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                       Cell{2, 1, {0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
                                       Cell{3, 1, {0, 0, 1}, {1, 0, 0}, {0, -1, 0}}};
    const EnvironmentImage image = black_image(Layout::VerticalCross, Sampling::TexelCentres, 3);
    std::vector<glm::dvec3> directions(image.pixels.size(), glm::dvec3(0.0));
    for_each_pixel(shape_of(image), [&](std::size_t index, const PixelPlace& place) {
        directions[index] = place.direction;
    });
    std::size_t num_used = 0;
    for (const glm::dvec3& direction : directions)
        num_used += direction == glm::dvec3(0.0) ? 0u : 1u;
    EXPECT_EQ(num_used, 54u);
    for (const Cell& cell : table) {
        const auto at = [&](std::size_t x, std::size_t y) {
            return directions[(cell.row * 3 + y) * 9 + cell.column * 3 + x];
        };
        EXPECT_NEAR(glm::distance(at(1, 1), cell.direction), 0.0, 1e-14);
        EXPECT_GT(glm::dot(at(2, 1), cell.right), 0.5);
        EXPECT_GT(glm::dot(at(1, 0), cell.up), 0.5);
    }
}

TEST(ImageLayout, OnlyMatchingProportionsFit) {
    EXPECT_TRUE(fits(Layout::Cube, 5, 30));
    EXPECT_FALSE(fits(Layout::Cube, 5, 31));
    EXPECT_TRUE(fits(Layout::VerticalCross, 9, 12));
    EXPECT_FALSE(fits(Layout::VerticalCross, 3, 5));
    EXPECT_FALSE(fits(Layout::LatLong, 0, 5));
    EXPECT_THROW(FaceSquares(Layout::Cube, 6, 35), std::invalid_argument);
    EXPECT_THROW(FaceSquares(Layout::LatLong, 64, 32), std::invalid_argument);
}

} // namespace
} // namespace relumine::cubemap
