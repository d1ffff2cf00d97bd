#include "relight/light_fit/projected_gradient.h"

#include <vector>

#include <gtest/gtest.h>

#include "prt/work.h"

namespace relumine::relight {
namespace {

const GradientOptions Exact{.max_iterations = 2000, .tolerance = 0.0};

TEST(ProjectedGradient, FindsTheLeastOfAParabolaAmongTheNonNegative) {
    // Sum of a_i (x_i - b_i)^2 / 2: each unknown is max(b_i, 0) in the end, however different the
    // curvatures are.
    const std::vector<double> a = {1.0, 1e3, 1e-2, 5.0}, b = {3.0, 0.2, -4.0, -1e-3};
    std::vector<double> x(4, 1.0);
    const GradientReport report = minimise_non_negative(
        [&](std::span<const double> at, std::span<double> gradient) {
            double value = 0.0;
            for (std::size_t i = 0; i < 4; ++i) {
                gradient[i] = a[i] * (at[i] - b[i]);
                value += 0.5 * gradient[i] * (at[i] - b[i]);
            }
            return value;
        },
        x, Exact);
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_NEAR(x[i], std::max(b[i], 0.0), 1e-6);
    EXPECT_NEAR(report.value, 0.5 * (1e-2 * 16.0 + 5.0 * 1e-6), 1e-9);
}

TEST(ProjectedGradient, CrossesACurvedValley) {
    // Rosenbrock's function: 0 at (1, 1). And with its valley beyond the border: the least is on
    // it.
    const auto valley = [](std::span<const double> x, std::span<double> gradient) {
        const double along = 1.0 - x[0], across = x[1] - x[0] * x[0];
        gradient[0] = -2.0 * along - 400.0 * x[0] * across;
        gradient[1] = 200.0 * across;
        return along * along + 100.0 * across * across;
    };
    std::vector<double> x = {0.0, 3.0};
    static_cast<void>(minimise_non_negative(valley, x, Exact));
    EXPECT_NEAR(x[0], 1.0, 1e-4);
    EXPECT_NEAR(x[1], 1.0, 1e-4);
    const auto shifted = [&](std::span<const double> y, std::span<double> gradient) {
        const std::vector<double> moved = {y[0] - 0.5, y[1] + 2.0};
        return valley(moved, gradient);
    };
    x = {1.0, 1.0};
    static_cast<void>(minimise_non_negative(shifted, x, Exact));
    EXPECT_EQ(x[1], 0.0);
    // There 400 u^3 - 798 u - 2 = 0 for u = x - 0.5.
    const double u = x[0] - 0.5;
    EXPECT_NEAR(400.0 * u * u * u - 798.0 * u - 2.0, 0.0, 0.1);
}

TEST(ProjectedGradient, StopsAndTellsHowFarItIs) {
    std::vector<double> x = {5.0};
    const Objective square = [](std::span<const double> at, std::span<double> gradient) {
        gradient[0] = 2.0 * at[0];
        return at[0] * at[0];
    };
    std::stop_source source;
    source.request_stop();
    EXPECT_THROW(minimise_non_negative(square, x, {}, {.stop = source.get_token()}),
                 prt::Cancelled);
    double last = 0.0;
    const GradientReport report = minimise_non_negative(square, x, {.max_iterations = 4},
                                                        {.on_progress = [&](double fraction) {
                                                            last = fraction;
                                                        }});
    EXPECT_LE(report.num_iterations, 4u);
    EXPECT_GT(last, 0.0);
    EXPECT_LE(x[0], 5.0);
}

} // namespace
} // namespace relumine::relight
