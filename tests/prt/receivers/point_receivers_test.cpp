#include "prt/receivers/point_receivers.h"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "prt/precompute.h"
#include "tests/prt/analytic_blockers.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

TEST(PointReceivers, GridsHaveTheMiddlesOfTheirCells) {
    const GridLayout grid{.nx = 2, .ny = 1, .nz = 3, .low = {0, 0, 0}, .high = {4, 2, 3}};
    const std::vector<glm::vec3> points = grid_points(grid);
    ASSERT_EQ(points.size(), 6u);
    EXPECT_EQ(points[0], glm::vec3(1, 1, 0.5f));
    EXPECT_EQ(points[1], glm::vec3(3, 1, 0.5f));
    EXPECT_EQ(points[2], glm::vec3(1, 1, 1.5f));
    EXPECT_EQ(description(grid), "grid 2 x 1 x 3");
    EXPECT_EQ(num_places(grid), 6u);
}

TEST(PointReceivers, PointsInsideLookFromTheNearestPointOutside) {
    const mesh::TriangleMesh box = scenes::box({-1, -1, -1}, {1, 1, 1});
    const RayScene rays(box);
    const std::vector<glm::vec3> points = {{0, 0, 0}, {3, 0, 0}, {0.5f, 0.9f, 0}, {0, 2, 0}};
    const Receivers receivers = point_receivers(points, box, rays);
    EXPECT_TRUE(receivers.have_no_surface);
    EXPECT_EQ(num_inside(receivers), 2u);
    EXPECT_TRUE(receivers.is_inside(0));
    EXPECT_FALSE(receivers.is_inside(1));
    EXPECT_EQ(receivers.positions[0], points[3]);
    EXPECT_EQ(receivers.positions[2], points[3]);
    EXPECT_EQ(receivers.positions[1], points[1]);
    EXPECT_EQ(receivers.places(), points);
    EXPECT_EQ(receivers.normals, std::vector<glm::vec3>(4, glm::vec3(0.0f)));
}

TEST(PointReceivers, NearestIsThatOfALoopOverAll) {
    const mesh::TriangleMesh box = scenes::box({-1, -1, -1}, {1, 1, 1});
    const GridLayout grid{.nx = 7, .ny = 6, .nz = 5, .low = {-2, -2, -2}, .high = {2, 2, 2.5f}};
    const std::vector<glm::vec3> points = grid_points(grid);
    const Receivers receivers = point_receivers(points, box, RayScene(box));
    EXPECT_GT(num_inside(receivers), 10u);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto is_in = [&](const glm::vec3& p) {
            return std::abs(p.x) < 1 && std::abs(p.y) < 1 && std::abs(p.z) < 1;
        };
        EXPECT_EQ(receivers.is_inside(i), is_in(points[i]));
        if (!is_in(points[i]))
            continue;
        std::size_t best = points.size();
        double least = std::numeric_limits<double>::max();
        for (std::size_t j = 0; j < points.size(); ++j) {
            const glm::dvec3 away = glm::dvec3(points[j]) - glm::dvec3(points[i]);
            if (!is_in(points[j]) && glm::dot(away, away) < least) {
                least = glm::dot(away, away);
                best = j;
            }
        }
        EXPECT_EQ(receivers.positions[i], points[best]) << i;
    }
}

TEST(PointReceivers, WhereAllAreInsideAllStay) {
    const mesh::TriangleMesh box = scenes::box({-1, -1, -1}, {1, 1, 1});
    const std::vector<glm::vec3> points = {{0, 0, 0}, {0.2f, 0, 0}};
    const Receivers receivers = point_receivers(points, box, RayScene(box));
    EXPECT_EQ(receivers.positions, points);
    EXPECT_EQ(num_inside(receivers), 0u);
}

TEST(PointReceivers, RefusesWhatIsNoPoint) {
    const mesh::TriangleMesh box = scenes::box({-1, -1, -1}, {1, 1, 1});
    const RayScene rays(box);
    EXPECT_THROW(static_cast<void>(point_receivers({}, box, rays)), std::invalid_argument);
    const std::vector<glm::vec3> points = {{0, 0, std::numeric_limits<float>::quiet_NaN()}};
    try {
        static_cast<void>(point_receivers(points, box, rays));
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_STREQ(error.what(), "expected points with finite coordinates, got (0, 0, nan) as "
                                   "point 0");
    }
}

TEST(PointReceivers, CountsAreOfTheWholeSphere) {
    Receivers points;
    points.have_no_surface = true;
    for (int i = 0; i < 20; ++i)
        points.positions.emplace_back(0.0f, -2.0f - 0.01f * static_cast<float>(i), 0.0f);
    points.normals.resize(points.size(), glm::vec3(0.0f));
    const Transfer transfer =
        precompute(points, scenes::sphere_blocker({0, 0, 0}, 1.0), {.min_level = 3});
    EXPECT_EQ(transfer.num_points, transfer.num_receivers());
    double seen = 0.0;
    for (std::size_t leaf = 0; leaf < transfer.num_clusters(); ++leaf) {
        const Cell& cell = transfer.quadtree.leaves()[leaf];
        const double s = cell.x * cell.size(), t = cell.y * cell.size();
        const double angle = cubemap::solid_angle(s, t, s + cell.size(), t + cell.size());
        for (std::size_t place = 0; place < 20; ++place)
            seen += transfer.counts.count(place, leaf) / 16.0 * angle;
    }
    double expected = 0.0;
    for (int i = 0; i < 20; ++i) {
        const double sine = 1.0 / (2.0 + 0.01 * i);
        expected += 2.0 * 3.14159265 * (1.0 + std::sqrt(1.0 - sine * sine));
    }
    EXPECT_NEAR(seen / expected, 1.0, 1e-3);
}

} // namespace
} // namespace relumine::prt
