#include "viewer/lat_long_view.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "viewer/quadtree_lines.h"

namespace relumine::viewer {
namespace {

constexpr PixelRectangle MapViewport{.x = 100, .y = 50, .width = 800, .height = 400};

TEST(LatLong, AxesLieWhereOpenExrHasThem) {
    EXPECT_LT(glm::length(lat_long({0, 0, 1}) - glm::dvec2(0.5, 0.5)), 1e-12);
    EXPECT_LT(glm::length(lat_long({1, 0, 0}) - glm::dvec2(0.25, 0.5)), 1e-12);
    EXPECT_LT(glm::length(lat_long({-1, 0, 0}) - glm::dvec2(0.75, 0.5)), 1e-12);
    EXPECT_NEAR(lat_long({0, 1, 0}).y, 0.0, 1e-12);
    EXPECT_NEAR(lat_long({0, -1, 0}).y, 1.0, 1e-12);
}

TEST(LatLong, DirectionsComeBack) {
    for (int i = 0; i < 15; ++i)
        for (int j = 0; j < 15; ++j) {
            const glm::dvec2 uv(0.01 + 0.07 * i, 0.01 + 0.07 * j - (j == 14 ? 0.02 : 0.0));
            EXPECT_LT(glm::length(lat_long(direction_at(uv)) - uv), 1e-12);
        }
}

TEST(LatLong, LinesOverTheSeamHaveNoJumps) {
    std::vector<glm::dvec3> circle;
    for (int i = 0; i <= 100; ++i) {
        const double angle = 2.0 * 3.14159265358979 * i / 100.0;
        circle.push_back(
            glm::normalize(glm::dvec3(0.3 * std::cos(angle), 0.3 * std::sin(angle), -1.0)));
    }
    const std::vector<glm::dvec2> uv = unrolled(circle);
    for (std::size_t i = 1; i < uv.size(); ++i)
        EXPECT_LT(std::abs(uv[i].x - uv[i - 1].x), 0.02);
}

TEST(LatLongView, PixelsAndDirectionsAgreeHoweverPannedAndZoomed) {
    LatLongView view;
    view.zoom_at(MapViewport, {300, 200}, 6.0);
    view.pan(MapViewport, {-5000.0, 40.0});
    for (int x = 120; x < 900; x += 60)
        for (int y = 60; y < 450; y += 40) {
            const std::optional<glm::dvec3> direction = view.direction(MapViewport, {x, y});
            ASSERT_TRUE(direction);
            const glm::dvec2 pixel = view.pixel_of(MapViewport, *direction);
            EXPECT_NEAR(pixel.x, x, 1e-6);
            EXPECT_NEAR(pixel.y, y, 1e-6);
        }
}

TEST(LatLongView, ZoomingKeepsWhatIsUnderThePointer) {
    LatLongView view;
    const glm::dvec2 pixel(650.0, 220.0);
    const glm::dvec2 before = view.uv_at(MapViewport, pixel);
    view.zoom_at(MapViewport, pixel, 5.0);
    EXPECT_NEAR(view.uv_at(MapViewport, pixel).x, before.x, 1e-12);
    EXPECT_NEAR(view.uv_at(MapViewport, pixel).y, before.y, 1e-12);
}

TEST(LatLongView, NothingLiesBeyondThePoles) {
    LatLongView view;
    const PixelRectangle high{.x = 0, .y = 0, .width = 400, .height = 400};
    EXPECT_FALSE(view.direction(high, {200, 20}));
    EXPECT_TRUE(view.direction(high, {200, 200}));
    view.pan(MapViewport, {0.0, 1e6});
    EXPECT_NEAR(view.center.y, 0.5, 1e-12); // all of it is seen: it stays
}

TEST(QuadtreeLines, CoverEveryEdgeOfTheCube) {
    const std::vector<glm::vec2> ends = quadtree_lines(prt::Quadtree());
    // Six faces whole: four sides of 32 pieces each, two ends.
    EXPECT_EQ(ends.size(), std::size_t{6} * 4 * 32 * 2);
    for (std::size_t i = 0; i < ends.size(); i += 2)
        EXPECT_LT(std::abs(ends[i].x - ends[i + 1].x), 0.51f);
}

} // namespace
} // namespace relumine::viewer
