// Lists of words in one line.
#pragma once

#include <span>
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

/// Returns the choices of an error: "a, b or c".
template<class Words>
[[nodiscard]] std::string joined_by_or(const Words& words) {
    const std::span<const typename Words::value_type> all(words);
    if (all.size() < 2)
        return joined(all, "");
    std::string line = joined(all.first(all.size() - 1), ", ");
    line += " or ";
    line += all.back();
    return line;
}

} // namespace relumine::files
