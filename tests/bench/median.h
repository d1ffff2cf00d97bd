// The middle of several measurements: one slow run does not move it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace relumine::bench {

/// Of an even number the upper of the two in the middle. `values` must not be empty.
inline double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
}

} // namespace relumine::bench
