// Small images for the tests of materials.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <stb/stb_image_write.h> // Debian's libstb is compiled

namespace relumine::mesh {

using Rgb8 = std::array<std::uint8_t, 3>;

inline constexpr Rgb8 Red = {255, 0, 0}, Green = {0, 255, 0}, Blue = {0, 0, 255},
                      Gray = {128, 128, 128};

/// A PNG file of the pixels, the top row first.
inline std::string png(int width, int height, const std::vector<Rgb8>& pixels) {
    std::string file;
    const auto append = [](void* to, void* data, int size) {
        static_cast<std::string*>(to)->append(static_cast<const char*>(data),
                                              static_cast<std::size_t>(size));
    };
    stbi_write_png_to_func(append, &file, width, height, 3, pixels.data(), 3 * width);
    return file;
}

/// Red and green above blue and grey.
inline std::string four_colors() {
    return png(2, 2, {Red, Green, Blue, Gray});
}

} // namespace relumine::mesh
