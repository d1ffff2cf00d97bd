// Texts of files as people may see them.
#pragma once

#include <string>
#include <string_view>

namespace relumine::files {

/// Returns a text whose control characters, which a terminal may obey, and whose bytes that are no
/// UTF-8 became `instead`.
[[nodiscard]] std::string printable(std::string_view text, char instead = '?');

} // namespace relumine::files
