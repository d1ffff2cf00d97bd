// Numbers of things in sentences.
#pragma once

#include <cstddef>
#include <string>

namespace relumine::files {

/// Returns "1 light" or "7 lights" for "light".
[[nodiscard]] inline std::string counted(std::size_t number, const std::string& thing) {
    return std::to_string(number) + " " + thing + (number == 1 ? "" : "s");
}

} // namespace relumine::files
