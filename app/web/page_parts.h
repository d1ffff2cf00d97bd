// Where the parts of the page are that every exported scene has: what `./dev web` builds.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "app/web/web_files.h"

namespace relumine::app {

inline constexpr std::string_view PageTemplate = "index.html";
inline constexpr std::string_view PageScript = "relumine-viewer.js";
inline constexpr std::string_view PageRuntime = "relumine.wasm.gz";
inline constexpr std::string_view PageLicense = "LICENSE-three.txt";

/// Where they are looked for, in this order: the folder that RELUMINE_WEB names, where an
/// installation has them, and where a build has them.
[[nodiscard]] std::vector<std::filesystem::path> page_part_folders();

/// Reads the parts.
///
/// Throws:  std::runtime_error that says how to get them.
[[nodiscard]] WebFiles find_page_parts();

} // namespace relumine::app
