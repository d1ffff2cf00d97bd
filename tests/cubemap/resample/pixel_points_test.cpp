#include "cubemap/resample/pixel_points.h"

#include <vector>

#include <gtest/gtest.h>

#include "cubemap/image/environment.h"

namespace relumine::cubemap {
namespace {

TEST(PixelPoints, OfFacesAreTheirDirections) {
    const ImageShape shape{Layout::VerticalCross, Sampling::TexelCentres, 15, 20};
    const FaceSquares squares(shape.layout, shape.width, shape.height);
    std::size_t num_visited = 0;
    std::vector<std::vector<glm::dvec3>> found(300);
    for_each_pixel_points(shape, [&](std::size_t pixel, std::span<const glm::dvec3> points) {
        found[pixel].assign(points.begin(), points.end());
    });
    for (const Face face : AllFaces)
        for (std::uint32_t y = 0; y < 5; ++y)
            for (std::uint32_t x = 0; x < 5; ++x) {
                const auto& points = found[squares.pixel(face, x, y)];
                ASSERT_EQ(points.size(), 4u);
                for (std::uint32_t i = 0; i < 4; ++i) {
                    const double s = x + ((i & 1u) != 0 ? 0.75 : 0.25),
                                 t = y + ((i & 2u) != 0 ? 0.75 : 0.25);
                    EXPECT_LT(glm::distance(points[i], direction(face, s / 5.0, t / 5.0)), 1e-12);
                }
                ++num_visited;
            }
    EXPECT_EQ(num_visited, 150u);
}

} // namespace
} // namespace relumine::cubemap
