// The time that the clustering expects, against what its levels took.
#include "prt/clusters/work_estimate.h"

#include <vector>

#include <gtest/gtest.h>

namespace relumine::prt {
namespace {

struct LevelTime {
    std::uint32_t level;
    std::size_t num_cells;
    std::size_t num_clusters;
    double seconds;
};

/// A scan of 36,000 vertices on a floor, and one of 35,000 with highlights, as measured.
const std::vector<std::vector<LevelTime>> Measured = {{{3, 384, 114, 2.706},
                                                       {4, 1080, 383, 3.685},
                                                       {5, 2788, 1256, 8.155},
                                                       {6, 6128, 2582, 13.498},
                                                       {7, 14184, 7756, 20.613},
                                                       {8, 25712, 25712, 26.009}},
                                                      {{3, 384, 31, 1.849},
                                                       {4, 1412, 92, 2.819},
                                                       {5, 5280, 2559, 11.364},
                                                       {6, 10884, 9400, 19.551},
                                                       {7, 5936, 5916, 15.584},
                                                       {8, 80, 80, 0.459}}};

TEST(WorkEstimate, AfterAFifthOfTheTimeTheRestIsKnownToThirtyPercent) {
    for (const std::vector<LevelTime>& levels : Measured) {
        double all = 0.0;
        for (const LevelTime& level : levels)
            all += level.seconds;
        WorkEstimate estimate(8);
        auto level = levels.begin();
        for (; estimate.seconds() < 0.19 * all; ++level)
            estimate.add(level->level, level->num_cells, level->num_cells - level->num_clusters,
                         level->seconds);
        WorkEstimate::Counts cells{};
        cells[level->level] = level->num_cells;
        const double left = all - estimate.seconds();
        EXPECT_NEAR(estimate.seconds_of(cells), left, 0.3 * left);
    }
}

TEST(WorkEstimate, DeeperLevelsGoOnAlike) {
    // Half of the cells of each level are split, so 0.95 of a half is expected below, and a cell
    // takes seven tenths of its parent's time.
    WorkEstimate estimate(5);
    estimate.add(2, 64, 32, 64.0);
    estimate.add(3, 128, 64, 89.6);
    WorkEstimate::Counts cells{};
    cells[4] = 256;
    EXPECT_DOUBLE_EQ(estimate.seconds_of(cells), 256 * 0.49 + 512 * 0.95 * 0.343);
    cells[4] = 0;
    cells[5] = 8;
    EXPECT_DOUBLE_EQ(estimate.seconds_of(cells), 8 * 0.343);
    EXPECT_DOUBLE_EQ(estimate.seconds_of({}), 0.0);
    EXPECT_DOUBLE_EQ(estimate.seconds(), 153.6);
}

TEST(WorkEstimate, ExpectsSomethingBeforeAnythingIsKnown) {
    const WorkEstimate estimate(8);
    WorkEstimate::Counts cells{};
    cells[3] = 384;
    EXPECT_GT(estimate.seconds_of(cells), 384 * estimate.seconds_of_cell(3));
}

} // namespace
} // namespace relumine::prt
