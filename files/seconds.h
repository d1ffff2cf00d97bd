// How long something took.
#pragma once

#include <chrono>

namespace relumine::files {

/// Returns the seconds from a moment until now.
[[nodiscard]] inline double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

} // namespace relumine::files
