// The extension of a file's name, which tells its format.
#pragma once

#include <filesystem>
#include <string>

namespace relumine::files {

/// Returns the extension in small letters, with the dot.
[[nodiscard]] std::string extension_of(const std::filesystem::path& path);

} // namespace relumine::files
