// Numbers of files that are out of their range.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace relumine::mesh {

/// Brings a value of `whose`, such as "light Key", into its range: one that is out of it costs no
/// more than itself, and a warning. A rounding outside is not said.
[[nodiscard]] inline double clamped(const std::string& whose, std::string_view key, double value,
                                    double low, double high, std::vector<std::string>& warnings) {
    const double result = std::clamp(value, low, high);
    constexpr double Rounding = 1e-4; // of a float, or of four decimals
    if (std::abs(value - result) > Rounding)
        warnings.push_back(
            fmt::format("the {}: expected {:g} to {:g} as \"{}\", got {:g}: it counts as {:g}",
                        whose, low, high, key, value, result));
    return result;
}

} // namespace relumine::mesh
