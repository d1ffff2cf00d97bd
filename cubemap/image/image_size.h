// The size of an image file, from its header.
#pragma once

#include <filesystem>

#include "cubemap/image/environment.h"

namespace relumine::cubemap {

/// Returns the size that load_environment() would find. Pixels are not read, so a damaged file may
/// still have a size.
/// Throws:  std::runtime_error "path: expected X, got Y".
[[nodiscard]] ImageSize read_image_size(const std::filesystem::path& path);

} // namespace relumine::cubemap
