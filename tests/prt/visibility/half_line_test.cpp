#include "prt/visibility/half_line.h"

#include <algorithm>
#include <random>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

using Corners = std::array<glm::dvec3, 3>;

/// The least distance of the half-line's points from the triangle's, among those of fine grids on
/// both.
double sampled_distance(const Corners& corners, const glm::dvec3& w) {
    constexpr int Steps = 60;
    double least = 1e9;
    for (int i = 0; i <= Steps; ++i)
        for (int j = 0; i + j <= Steps; ++j) {
            const double a = static_cast<double>(i) / Steps;
            const double b = static_cast<double>(j) / Steps;
            const glm::dvec3 point = a * corners[0] + b * corners[1] + (1.0 - a - b) * corners[2];
            const double along = std::max(0.0, glm::dot(point, w));
            least = std::min(least, glm::distance(point, along * w));
        }
    return least;
}

TEST(HalfLine, PassesByAtTheSampledDistance) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    int num_hits = 0;
    for (int i = 0; i < 3000; ++i) {
        Corners corners;
        for (glm::dvec3& corner : corners)
            corner = {uniform(random), uniform(random), uniform(random)};
        if (i % 3 == 0) // a needle
            corners[2] = glm::mix(corners[0], corners[1], uniform(random)) + 1e-3 * corners[2];
        const glm::dvec3 w = glm::normalize(glm::dvec3(scenes::random_direction(random)));
        const double distance = sampled_distance(corners, w);
        constexpr double Grid = 0.05; // half a grid's triangle
        EXPECT_TRUE(distance < Grid || passes_by(corners, w, 0.7 * (distance - Grid))) << i;
        EXPECT_FALSE(passes_by(corners, w, distance * 1.0001 + 1e-12)) << i;
        num_hits += passes_by(corners, w, 1e-12) ? 0 : 1;
    }
    EXPECT_GT(num_hits, 100);
}

TEST(HalfLine, SeesTheStartAsWellAsTheLine) {
    const Corners above = {{{-1, -1, 0.5}, {1, -1, 0.5}, {0, 1, 0.5}}};
    EXPECT_FALSE(passes_by(above, {0, 0, 1}, 0.0));
    EXPECT_TRUE(passes_by(above, {0, 0, -1}, 0.49)); // behind
    EXPECT_FALSE(passes_by(above, {0, 0, -1}, 0.51));
    EXPECT_TRUE(passes_by(above, {1, 0, 0}, 0.49)); // along it
    EXPECT_FALSE(passes_by(above, {1, 0, 0}, 0.51));
    const Corners in_plane = {{{1, -1, 0}, {3, -1, 0}, {2, 0.5, 0}}};
    EXPECT_FALSE(passes_by(in_plane, {1, 0, 0}, 1e-9));
    EXPECT_TRUE(passes_by(in_plane, {-1, 0, 0}, 0.9));
    EXPECT_TRUE(passes_by(in_plane, {0, 1, 0}, 0.9));
}

} // namespace
} // namespace relumine::prt
