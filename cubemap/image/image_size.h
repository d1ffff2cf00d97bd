// How large an image file is, from its header.
#pragma once

#include <filesystem>

#include "cubemap/image/environment.h"

namespace relumine::cubemap {

/// The size that load_environment() would find, without reading the pixels: an intact header says
/// nothing about them. Throws std::runtime_error "path: expected X, got Y".
[[nodiscard]] ImageSize read_image_size(const std::filesystem::path& path);

} // namespace relumine::cubemap
