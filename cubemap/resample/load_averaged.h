// Reads maps that are finer than what they light can use.
#pragma once

#include <cstdint>
#include <filesystem>

#include "cubemap/image/environment.h"

namespace relumine::cubemap {

/// Reads an environment as load_environment() does. A lat-long wider than `most_width` is never
/// held whole: bands of its rows become the means of 2, 3, ... rows and columns as they are read.
///
/// Energy:  kept exactly, as resample() keeps it. Bad and transparent pixels are counted, judged
///          and replaced in the file's own size.
/// Memory:  the smaller picture, and some bands. Cubes, pictures of six files, and files
///          without ImageRows take as much as they do for load_environment().
/// Cost:    files with pixels to be replaced are read twice.
/// Throws:  as load_environment().
[[nodiscard]] EnvironmentImage load_averaged(const std::filesystem::path& path,
                                             const LoadOptions& options, std::uint32_t most_width);

} // namespace relumine::cubemap
