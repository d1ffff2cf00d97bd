// Least squares with non-negative unknowns.
#pragma once

#include <span>

namespace relumine::relight {

/// Minimises |A x - b|^2 over x >= 0, given A^T A [n * n] and A^T b [n]. `x` [n] holds a start >=
/// 0, best near the solution; afterwards it holds the solution. Columns that nearly repeat each
/// other are safe.
///
/// Cost:    O(k^3) for k positive unknowns, times the few unknowns that become or cease to be
///          positive.
/// Source:  Lawson and Hanson, "Solving Least Squares Problems", 1974, chapter 23.
void fit_non_negative(std::span<const double> gram, std::span<const double> target,
                      std::span<double> x);

} // namespace relumine::relight
