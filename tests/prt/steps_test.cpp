#include <vector>

#include <gtest/gtest.h>

#include "prt/steps.h"

namespace relumine::prt {
namespace {

TEST(Progress, GoesOnWhereAnEarlierStageThoughtThatMoreWasDone) {
    std::vector<double> fractions;
    const Work work{.on_progress = [&](double fraction) {
        fractions.push_back(fraction);
    }};
    Progress progress(work);
    progress.start_stage(0.0, 0.6);
    progress.report(1.0);
    progress.start_stage(0.2, 0.4); // a fifth of the work is done, no more
    for (const double part : {0.25, 0.5, 1.0})
        progress.report(part);
    // A quarter of what is left takes a quarter of what is left of the scale.
    EXPECT_EQ(fractions.size(), 4u);
    EXPECT_DOUBLE_EQ(fractions.back(), 0.6 + 0.4 * 0.25);
    progress.start_stage(0.4, 1.0);
    progress.report(1.0);
    EXPECT_DOUBLE_EQ(fractions.back(), 1.0);
}

TEST(Progress, JumpsToWhereALaterEstimateIs) {
    std::vector<double> fractions;
    const Work work{.on_progress = [&](double fraction) {
        fractions.push_back(fraction);
    }};
    Progress progress(work);
    progress.start_stage(0.0, 0.1);
    progress.report(1.0);
    progress.start_stage(0.6, 0.8);
    progress.report(0.5);
    EXPECT_EQ(fractions, (std::vector{0.1, 0.7}));
}

TEST(Progress, NeverFalls) {
    std::vector<double> fractions;
    const Work work{.on_progress = [&](double fraction) {
        fractions.push_back(fraction);
    }};
    Progress progress(work);
    progress.start_stage(0.0, 1.0);
    for (const double part : {0.5, 0.25, 0.75})
        progress.report(part);
    EXPECT_EQ(fractions, (std::vector{0.5, 0.75}));
}

} // namespace
} // namespace relumine::prt
