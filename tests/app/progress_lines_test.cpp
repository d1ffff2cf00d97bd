#include "app/progress_lines.h"

#include <vector>

#include <gtest/gtest.h>

namespace relumine::app {
namespace {

/// The moments of the lines of work that goes on evenly, told of ten times a second.
std::vector<double> lines_of(double seconds) {
    ProgressLines lines;
    std::vector<double> moments;
    for (int i = 1; i <= static_cast<int>(10.0 * seconds); ++i)
        if (lines.is_due(0.1 * i / seconds, 0.1 * i))
            moments.push_back(0.1 * i);
    return moments;
}

TEST(ProgressLines, ShortWorkSaysLittle) {
    EXPECT_TRUE(lines_of(4.0).empty());
    EXPECT_LE(lines_of(20.0).size(), 4u) << "five seconds apart";
}

TEST(ProgressLines, ComeWithEveryTenth) {
    const std::vector<double> moments = lines_of(200.0);
    ASSERT_EQ(moments.size(), 10u);
    for (std::size_t i = 0; i < moments.size(); ++i)
        EXPECT_NEAR(moments[i], 20.0 * static_cast<double>(i + 1), 0.2);
}

TEST(ProgressLines, AreNeverFarApart) {
    const std::vector<double> moments = lines_of(10.0 * 3600.0);
    ASSERT_GT(moments.size(), 50u);
    EXPECT_LT(moments.size(), 80u);
    EXPECT_NEAR(moments[0], 30.0, 0.2) << "soon, so that one knows how long it takes";
    for (std::size_t i = 1; i < moments.size(); ++i)
        EXPECT_LT(moments[i] - moments[i - 1], 600.2);
}

} // namespace
} // namespace relumine::app
