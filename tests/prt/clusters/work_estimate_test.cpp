// The time that the clustering expects, against what its levels took.
#include "prt/clusters/work_estimate.h"

#include <limits>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace relumine::prt {
namespace {

struct LevelTime {
    std::uint32_t level;
    WorkEstimate::Depths cells;
    double seconds;
};

/// Scans of 36,000 and 5,000 vertices on a floor, as measured.
const std::vector<std::vector<LevelTime>> Measured = {{{3, {121, 7, 37, 184, 35}, 0.918},
                                                       {4, {43, 487, 367, 155}, 1.115},
                                                       {5, {2251, 1209, 576}, 2.296},
                                                       {6, {4927, 2213}, 2.257},
                                                       {7, {8852}, 1.862}},
                                                      {{3, {147, 13, 36, 188}, 0.195},
                                                       {4, {60, 295, 585, 8}, 0.294},
                                                       {5, {1750, 1718, 84}, 0.731},
                                                       {6, {6636, 572}, 1.132},
                                                       {7, {2288}, 0.294}}};

constexpr float DefaultTolerance = 0.0135f;

TEST(WorkEstimate, AfterAFifthOfTheTimeTheRestIsKnownToAThird) {
    for (const std::vector<LevelTime>& levels : Measured) {
        double all = 0.0;
        for (const LevelTime& level : levels)
            all += level.seconds;
        WorkEstimate estimate(8, DefaultTolerance);
        auto level = levels.begin();
        for (; estimate.seconds() < 0.19 * all; ++level)
            estimate.add(level->level, level->cells, level->seconds);
        WorkEstimate::Counts cells{};
        cells[level->level] =
            std::accumulate(level->cells.begin(), level->cells.end(), std::size_t{0});
        const double left = all - estimate.seconds();
        EXPECT_NEAR(estimate.seconds_of(cells), left, left / 3.0);
    }
}

TEST(WorkEstimate, CellsFarOverTheLimitHaveManyLevelsBelow) {
    EXPECT_EQ(WorkEstimate::expected_depth(0.99), 0);
    EXPECT_EQ(WorkEstimate::expected_depth(1.0), 1);
    EXPECT_EQ(WorkEstimate::expected_depth(1.99), 1);
    EXPECT_EQ(WorkEstimate::expected_depth(8.0), 4);
    EXPECT_EQ(WorkEstimate::expected_depth(std::numeric_limits<double>::infinity()), MaxLevel);
    EXPECT_EQ(WorkEstimate::expected_depth(std::numeric_limits<double>::quiet_NaN()), 0);
}

TEST(WorkEstimate, ChildrenHaveOneLevelLessBelow) {
    // Of 64 cells, 32 are split; the children of 8 are split again, and then no more. A cell takes
    // six tenths of its parent's time.
    WorkEstimate estimate(5, DefaultTolerance);
    estimate.add(2, {32, 24, 8}, 64.0);
    WorkEstimate::Counts cells{};
    cells[3] = 128;
    EXPECT_DOUBLE_EQ(estimate.seconds_of(cells), 128 * 0.6 + 4 * 32 * 0.36);
    // What a level shows counts more than what the level above it promised.
    estimate.add(3, {0, 64}, 64.0);
    cells[3] = 0;
    cells[4] = 256;
    EXPECT_DOUBLE_EQ(estimate.seconds_of(cells), 256 * 0.6);
    cells[4] = 0;
    cells[5] = 8;
    EXPECT_DOUBLE_EQ(estimate.seconds_of(cells), 8 * 0.36);
    EXPECT_DOUBLE_EQ(estimate.seconds_of({}), 0.0);
    EXPECT_DOUBLE_EQ(estimate.seconds(), 128.0);
}

TEST(WorkEstimate, CellsOfTheDeepestLevelAreNeverSplit) {
    WorkEstimate estimate(3, DefaultTolerance);
    estimate.add(2, {0, 0, 0, 16}, 16.0);
    WorkEstimate::Counts cells{};
    cells[3] = 64;
    EXPECT_DOUBLE_EQ(estimate.seconds_of(cells), 64 * 0.6);
}

TEST(WorkEstimate, ExpectsSomethingBeforeAnythingIsKnown) {
    const WorkEstimate estimate(8, DefaultTolerance);
    WorkEstimate::Counts cells{};
    cells[3] = 384;
    EXPECT_GT(estimate.seconds_of(cells), 384 * estimate.seconds_of_cell(3));
}

// As long as nothing is known, what the bunny on its floor took: 20 times its first level at the
// default tolerance, hardly more than that at a coarse one.
TEST(WorkEstimate, ExpectsWhatTheToleranceSays) {
    const auto times_first = [](float tolerance) {
        const WorkEstimate estimate(8, tolerance);
        WorkEstimate::Counts cells{};
        cells[0] = 6;
        return estimate.seconds_of(cells) / (6 * estimate.seconds_of_cell(0));
    };
    EXPECT_NEAR(times_first(DefaultTolerance), 20.0, 2.0);
    EXPECT_NEAR(times_first(0.03f), 2.2, 0.3);
    EXPECT_NEAR(times_first(0.05f), 1.5, 0.3);
    EXPECT_GT(times_first(0.01f), 40.0);
}

} // namespace
} // namespace relumine::prt
