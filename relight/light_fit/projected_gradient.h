// Minimisation over unknowns that are not negative, given values and gradients.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "prt/work.h"

namespace relumine::relight {

struct GradientOptions {
    std::size_t max_iterations = 200;
    /// Ends where ten iterations lower the value by less than this part of it
    double tolerance = 1e-4;
};

struct GradientReport {
    double value = 0.0;
    std::size_t num_iterations = 0;
};

/// Returns the value at `x`, and writes its gradient.
using Objective = std::function<double(std::span<const double> x, std::span<double> gradient)>;

/// Minimises a smooth function over x >= 0. `x` holds a start >= 0; afterwards it holds the best
/// point that was found. The value there is never above that of the start.
///
/// Cost:    about one call of the objective for each iteration.
/// Throws:  prt::Cancelled.
/// Source:  Birgin, Martinez and Raydan, "Nonmonotone Spectral Projected Gradient Methods on Convex
///          Sets", 2000 (SPG2).
GradientReport minimise_non_negative(const Objective& objective, std::span<double> x,
                                     const GradientOptions& options = {},
                                     const prt::Work& work = {});

} // namespace relumine::relight
