// Lists of words in one line.
#pragma once

#include <string>
#include <string_view>

namespace relumine::files {

/// Returns `words`, strings of any kind, with `separator` between each two. (`fmt::join` compiles
/// the formatting of numbers again wherever it is called, which takes half a second.)
template<class Words>
[[nodiscard]] std::string joined(const Words& words, std::string_view separator) {
    std::string line;
    bool is_first = true;
    for (const std::string_view word : words) {
        if (!is_first)
            line += separator;
        line += word;
        is_first = false;
    }
    return line;
}

} // namespace relumine::files
