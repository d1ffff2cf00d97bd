#include "cubemap/grid_cut.h"

#include <cmath>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "cubemap/spherical_overlap.h"

namespace relumine::cubemap {
namespace {

const std::vector<double> Lines = {0.0, 0.1, 0.35, 0.5, 0.9, 1.0};

std::map<std::pair<std::size_t, std::size_t>, double> areas_of(Polygon polygon, bool periodic) {
    GridLines columns(Lines, periodic), rows(Lines, false);
    GridCutter cutter;
    std::map<std::pair<std::size_t, std::size_t>, double> areas;
    cutter.cut(polygon, columns, rows,
               [&](std::size_t column, std::size_t row, const Polygon& piece) {
                   areas[{column, row}] += area(piece);
               });
    return areas;
}

TEST(GridCut, RectangleOverlapsAreProductsOfLengths) {
    const auto areas = areas_of({{0.05, 0.2}, {0.6, 0.2}, {0.6, 0.95}, {0.05, 0.95}}, false);
    EXPECT_NEAR(areas.at({0, 1}), 0.05 * 0.15, 1e-15);
    EXPECT_NEAR(areas.at({1, 2}), 0.25 * 0.15, 1e-15);
    EXPECT_NEAR(areas.at({3, 4}), 0.10 * 0.05, 1e-15);
    EXPECT_EQ(areas.count({4, 4}), 0u);
}

TEST(GridCut, PiecesOfAnyPolygonSumToIt) {
    // A star: not convex.
    Polygon star;
    for (int i = 0; i < 14; ++i) {
        const double angle = i * std::numbers::pi / 7.0, radius = i % 2 == 0 ? 0.48 : 0.2;
        star.emplace_back(0.5 + radius * std::cos(angle), 0.5 + radius * std::sin(angle));
    }
    double sum = 0.0;
    for (const auto& [cell, part] : areas_of(star, false)) {
        EXPECT_GE(part, -1e-15);
        sum += part;
    }
    EXPECT_NEAR(sum, area(star), 1e-15);
}

TEST(GridCut, PeriodicColumnsGoOnAfterTheLastAndBeforeTheFirst) {
    for (const double shift : {-3.0, -1.0, 0.0, 2.0}) {
        const auto areas = areas_of(
            {{shift + 0.95, 0.0}, {shift + 1.3, 0.0}, {shift + 1.3, 0.1}, {shift + 0.95, 0.1}},
            true);
        EXPECT_NEAR(areas.at({4, 0}), 0.05 * 0.1, 1e-15);
        EXPECT_NEAR(areas.at({0, 0}), 0.10 * 0.1, 1e-15);
        EXPECT_NEAR(areas.at({1, 0}), 0.20 * 0.1, 1e-15);
    }
}

TEST(SphericalOverlap, WholeFacesAndOctantsHaveTheirSolidAngles) {
    for (const std::uint32_t resolution : {1u, 3u, 40u, 200u}) {
        TexelOverlaps overlaps(resolution);
        double face_sum = 0.0, octant_sum = 0.0;
        const std::array<glm::dvec3, 4> face = {
            cube_point(Face::PositiveY, 0, 0), cube_point(Face::PositiveY, 1, 0),
            cube_point(Face::PositiveY, 1, 1), cube_point(Face::PositiveY, 0, 1)};
        overlaps.find(face, [&](Face where, std::uint32_t, std::uint32_t, double part) {
            EXPECT_EQ(where, Face::PositiveY);
            face_sum += part;
        });
        EXPECT_NEAR(face_sum / (4.0 * std::numbers::pi / 6.0), 1.0, 1e-6) << resolution;
        const std::array<glm::dvec3, 3> octant = {glm::dvec3(1, 0, 0), {0, 1, 0}, {0, 0, 1}};
        overlaps.find(octant,
                      [&](Face, std::uint32_t, std::uint32_t, double part) { octant_sum += part; });
        EXPECT_NEAR(std::abs(octant_sum) / (4.0 * std::numbers::pi / 8.0), 1.0, 1e-6) << resolution;
    }
}

} // namespace
} // namespace relumine::cubemap
