// How large an image file is, from its header.
#pragma once

#include <cstdint>
#include <filesystem>

namespace relumine::cubemap {

/// Pixels.
struct ImageSize {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    bool operator==(const ImageSize&) const = default;
};

/// The size that load_environment() would find, without reading the pixels: an intact header says nothing about them.
/// Throws std::runtime_error "path: expected X, got Y".
[[nodiscard]] ImageSize read_image_size(const std::filesystem::path& path);

} // namespace relumine::cubemap
