#include "tests/bench/plot.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace relumine::bench {
namespace {

using testing::HasSubstr;
using testing::Not;

// The plot area is x 72 to 550, y 40 to 384 (downwards).
TEST(Plot, PointsLieWhereTheAxesSay) {
    const std::string text = svg({.series = {{.name = "a", .x = {0.0, 10.0}, .y = {0.0, 5.0}}}});
    EXPECT_THAT(text, HasSubstr("points=\"72.0,384.0 550.0,40.0 \""));
    EXPECT_THAT(text, HasSubstr(">10</text>"));
    EXPECT_THAT(text, HasSubstr(">a</text>"));
}

TEST(Plot, LogarithmicAxesHaveEqualStepsForEqualRatios) {
    const std::string text =
        svg({.x_scale = Scale::Log,
             .y_scale = Scale::Log,
             .series = {{.name = "", .x = {1.0, 10.0, 100.0}, .y = {1.0, 10.0, 100.0}}}});
    // The middle of a range with equal margins.
    EXPECT_THAT(text, HasSubstr(" 311.0,212.0 "));
    EXPECT_THAT(text, HasSubstr(">50</text>"));
}

TEST(Plot, LeavesOutWhatNoAxisHas) {
    const std::string text =
        svg({.y_scale = Scale::Log,
             .series = {{.name = "", .x = {1.0, 2.0, 3.0}, .y = {1.0, 0.0, std::nan("")}}}});
    EXPECT_THAT(text, Not(HasSubstr("nan")));
    EXPECT_THAT(text, Not(HasSubstr("inf")));
}

TEST(Plot, TextIsEscapedAndNothingToShowIsAPlotToo) {
    const std::string text =
        svg({.title = "a < b & c", .x_label = {}, .y_label = {}, .series = {}});
    EXPECT_THAT(text, HasSubstr("a &lt; b &amp; c"));
    EXPECT_THAT(text, HasSubstr("</svg>"));
    EXPECT_THROW(static_cast<void>(svg({.series = {{.name = "", .x = {1.0}, .y = {}}}})),
                 std::invalid_argument);
}

} // namespace
} // namespace relumine::bench
