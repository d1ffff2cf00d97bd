#include "app/run_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "app/first_picture_stages.h"

namespace relumine::app {
namespace {

TEST(RunEstimate, OfAnEvenRunIsRightFromTheFirstWordOn) {
    RunEstimate run({{"first", 1.0}, {"second", 3.0}});
    EXPECT_FALSE(run.seconds_left(0.0)) << "nothing is known";
    run.tell(0, 0.0, 0.0);
    EXPECT_FALSE(run.seconds_left(0.5)) << "nothing is done";
    for (const double part : {0.1, 0.5, 1.0}) {
        run.tell(0, part, 10.0 * part);
        EXPECT_NEAR(*run.seconds_left(10.0 * part), 40.0 - 10.0 * part, 1e-9);
        EXPECT_NEAR(run.fraction(10.0 * part), part / 4.0, 1e-9);
    }
    run.tell(1, 0.5, 25.0);
    EXPECT_NEAR(*run.seconds_left(25.0), 15.0, 1e-9);
    EXPECT_EQ(run.present(), "second");
    run.tell(1, 1.0, 40.0);
    EXPECT_NEAR(*run.seconds_left(40.0), 0.0, 1e-9);
    EXPECT_NEAR(run.fraction(40.0), 1.0, 1e-9);
}

TEST(RunEstimate, AStageThatSaysNothingIsNotCounted) {
    RunEstimate run({{"skipped", 5.0}, {"first", 1.0}, {"second", 1.0}});
    run.tell(1, 1.0, 10.0);
    EXPECT_NEAR(*run.seconds_left(10.0), 10.0, 1e-9);
    EXPECT_EQ(run.find("second"), 2u);
    EXPECT_FALSE(run.find("third"));
    run.tell(0, 0.5, 11.0); // too late
    EXPECT_EQ(run.present(), "first");
}

TEST(RunEstimate, AStageThatSlowsDownIsSeen) {
    RunEstimate run({{"only", 1.0}});
    run.tell(0, 0.5, 10.0);
    const double before = *run.seconds_left(10.0);
    EXPECT_GT(*run.seconds_left(30.0), before) << "no word for 20 s";
    const double fraction = run.fraction(10.0);
    EXPECT_EQ(run.fraction(100.0), fraction) << "and the fraction does not fall";
}

// Processor seconds of `relumine relight MESH ENV` on one machine: first sight, refinement,
// clusters, bounces, picture.
struct Measured {
    const char* mesh;
    std::array<double, 5> seconds;
};
constexpr std::array Runs = {
    Measured{"DamagedHelmet", {7.6, 14.7, 7.5, 39.4, 29.8}},
    Measured{"cannon-large", {2.4, 6.7, 4.0, 9.7, 25.8}},
    Measured{"SheenChair", {5.5, 11.4, 12.9, 24.0, 58.1}},
};

TEST(RunEstimate, OfAFirstPictureHoldsFromAFifthOn) {
    const std::array<std::string, 5> names = {"first sight", "refine", "precompute", "bounces",
                                              "picture"};
    for (const Measured& made : Runs) {
        RunEstimate run(first_picture_stages(1024.0 * 768.0));
        double whole = 0.0, begin = 0.0, last = 0.0;
        for (const double seconds : made.seconds)
            whole += seconds;
        for (std::size_t stage = 0; stage < names.size(); ++stage) {
            for (int i = 0; i <= 100; ++i) {
                const double now = begin + 0.01 * i * made.seconds[stage];
                // The first sight says nothing before it is there.
                run.tell(*run.find(names[stage]), stage == 0 && i < 100 ? 0.0 : 0.01 * i, now);
                const double fraction = run.fraction(now);
                EXPECT_GE(fraction, last);
                last = fraction;
                if (now < 0.2 * whole)
                    continue;
                const double guess = now + run.seconds_left(now).value_or(0.0);
                EXPECT_LT(guess, 1.5 * whole) << made.mesh << " at " << now;
                EXPECT_GT(guess, whole / 1.5) << made.mesh << " at " << now;
            }
            begin += made.seconds[stage];
        }
        EXPECT_NEAR(last, 1.0, 1e-9);
    }
}

} // namespace
} // namespace relumine::app
