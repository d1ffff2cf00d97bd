#include "relight/light_fit/non_negative_fit.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace relumine::relight {
namespace {

/// A least-squares problem with its A^T A and A^T b.
struct Problem {
    std::size_t num_rows, num_columns;
    /// [row][column]
    std::vector<double> a;
    std::vector<double> b;
    std::vector<double> gram;
    std::vector<double> target;

    Problem(std::size_t rows, std::size_t columns, std::vector<double> matrix,
            std::vector<double> right)
        : num_rows(rows), num_columns(columns), a(std::move(matrix)), b(std::move(right)),
          gram(columns * columns), target(columns) {
        for (std::size_t i = 0; i < columns; ++i)
            for (std::size_t r = 0; r < rows; ++r) {
                target[i] += a[r * columns + i] * b[r];
                for (std::size_t j = 0; j < columns; ++j)
                    gram[i * columns + j] += a[r * columns + i] * a[r * columns + j];
            }
    }

    [[nodiscard]] double slope(std::size_t i, std::span<const double> x) const {
        double sum = target[i];
        for (std::size_t j = 0; j < num_columns; ++j)
            sum -= gram[i * num_columns + j] * x[j];
        return sum;
    }
};

Problem random_problem(std::mt19937& random, std::size_t rows, std::size_t columns) {
    std::uniform_real_distribution<double> element(0.0, 1.0);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    std::vector<double> a(rows * columns);
    std::vector<double> b(rows);
    for (double& x : a)
        x = element(random);
    for (double& x : b)
        x = any(random);
    return {rows, columns, a, b};
}

// Karush-Kuhn-Tucker: the error is flat along positive unknowns and does not fall along those that
// are zero.
void expect_optimal(const Problem& problem, std::span<const double> x) {
    for (std::size_t i = 0; i < x.size(); ++i) {
        EXPECT_GE(x[i], 0.0);
        const double scale = std::sqrt(problem.gram[i * x.size() + i]);
        if (x[i] > 0.0)
            EXPECT_NEAR(problem.slope(i, x), 0.0, 1e-6 * scale) << "unknown " << i;
        else
            EXPECT_LE(problem.slope(i, x), 1e-6 * scale) << "unknown " << i;
    }
}

TEST(NonNegativeFit, SolvesWhatNeedsNoConstraint) {
    const Problem problem(2, 2, {2.0, 0.0, 0.0, 4.0}, {6.0, 2.0});
    std::vector<double> x(2);
    fit_non_negative(problem.gram, problem.target, x);
    EXPECT_NEAR(x[0], 3.0, 1e-7);
    EXPECT_NEAR(x[1], 0.5, 1e-7);
}

TEST(NonNegativeFit, WhatWouldBeNegativeIsZeroAndTheOthersAreFittedWithoutIt) {
    // Without the constraint x = (3, -2); with it x1 = 0 and x0 = a0.b / a0.a0 = 1.
    const Problem problem(2, 2, {1.0, 1.0, 1.0, 2.0}, {1.0, -1.0 + 2.0});
    std::vector<double> x(2);
    fit_non_negative(problem.gram, problem.target, x);
    EXPECT_NEAR(x[0], 1.0, 1e-7);
    EXPECT_NEAR(x[1], 0.0, 1e-7);
}

TEST(NonNegativeFit, RandomProblemsEndWhereNothingHelps) {
    std::mt19937 random(1);
    for (const std::size_t columns : {1u, 2u, 5u, 20u, 60u})
        for (int i = 0; i < 20; ++i) {
            const Problem problem = random_problem(random, 80, columns);
            std::vector<double> x(columns);
            fit_non_negative(problem.gram, problem.target, x);
            expect_optimal(problem, x);
        }
}

TEST(NonNegativeFit, TheStartDoesNotMatter) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> start(0.0, 2.0);
    for (int i = 0; i < 20; ++i) {
        const Problem problem = random_problem(random, 60, 30);
        std::vector<double> cold(30);
        std::vector<double> warm(30);
        for (double& x : warm)
            x = start(random);
        fit_non_negative(problem.gram, problem.target, cold);
        fit_non_negative(problem.gram, problem.target, warm);
        expect_optimal(problem, warm);
        for (std::size_t k = 0; k < 30; ++k)
            EXPECT_NEAR(cold[k], warm[k], 1e-5);
    }
}

TEST(NonNegativeFit, ColumnsThatRepeatEachOtherShare) {
    const Problem problem(2, 3, {1.0, 1.0, 0.0, 1.0, 1.0, 1.0}, {1.0, 3.0});
    std::vector<double> x(3);
    fit_non_negative(problem.gram, problem.target, x);
    EXPECT_NEAR(x[0] + x[1], 1.0, 1e-6);
    EXPECT_NEAR(x[2], 2.0, 1e-6);
}

TEST(NonNegativeFit, NothingHelpsOrNothingIsThere) {
    const Problem problem(1, 1, {1.0}, {-1.0});
    std::vector<double> x(1);
    fit_non_negative(problem.gram, problem.target, x);
    EXPECT_EQ(x[0], 0.0);
    fit_non_negative({}, {}, {});
}

} // namespace
} // namespace relumine::relight
