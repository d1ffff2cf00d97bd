#include "cubemap/resample/pixel_points.h"

#include <vector>

#include <gtest/gtest.h>

#include "cubemap/image/environment.h"
#include "cubemap/image/projection.h"
#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

/// The points of each pixel on their own, without symmetries.
std::vector<std::vector<glm::dvec3>> plain_points(const ImageShape& shape) {
    const Projection& picture = *projection(shape.layout);
    std::vector<std::vector<glm::dvec3>> points;
    for (std::uint32_t y = 0; y < shape.height; ++y)
        for (std::uint32_t x = 0; x < shape.width; ++x) {
            auto& own = points.emplace_back();
            for (const double dy : {0.25, 0.75})
                for (const double dx : {0.25, 0.75}) {
                    const glm::dvec2 point((x + dx) / shape.width, (y + dy) / shape.height);
                    if (!picture.is_disc() || glm::distance(point, glm::dvec2(0.5)) < 0.5)
                        own.push_back(picture.direction(point));
                }
        }
    return points;
}

TEST(PixelPoints, OfMirroredPixelsAreThoseOfEachPixelInOrder) {
    for (const Layout layout : {Layout::AngularMap, Layout::MirrorBall, Layout::Octahedral}) {
        for (const std::uint32_t width : {15u, 24u}) {
            const ImageShape shape{layout, Sampling::TexelCentres, width, width};
            const auto expected = plain_points(shape);
            std::vector<std::vector<glm::dvec3>> found(expected.size());
            for_each_pixel_points(shape,
                                  [&](std::size_t pixel, std::span<const glm::dvec3> points) {
                                      found[pixel].assign(points.begin(), points.end());
                                  });
            for (std::size_t pixel = 0; pixel < found.size(); ++pixel) {
                ASSERT_EQ(found[pixel].size(), expected[pixel].size()) << name(layout) << pixel;
                for (std::size_t i = 0; i < found[pixel].size(); ++i)
                    EXPECT_LT(glm::distance(found[pixel][i], expected[pixel][i]), 1e-12)
                        << name(layout) << " " << pixel;
            }
        }
    }
}

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
