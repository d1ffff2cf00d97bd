// Small images for the tests of materials.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
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

/// The same with alpha.
inline std::string png_of_alpha(int width, int height,
                                const std::vector<std::array<std::uint8_t, 4>>& pixels) {
    std::string file;
    const auto append = [](void* to, void* data, int size) {
        static_cast<std::string*>(to)->append(static_cast<const char*>(data),
                                              static_cast<std::size_t>(size));
    };
    stbi_write_png_to_func(append, &file, width, height, 4, pixels.data(), 4 * width);
    return file;
}

/// One grey pixel of 16 bits; nobody reads the check sums.
inline std::string png_of_16_bits(std::uint16_t value) {
    const auto bytes = [](std::initializer_list<int> list) {
        std::string text;
        for (const int byte : list)
            text += static_cast<char>(byte);
        return text;
    };
    const auto chunk = [&](const std::string& type, const std::string& data) {
        return bytes({0, 0, 0, static_cast<int>(data.size())}) + type + data + "sums";
    };
    const std::string deflated =
        bytes({0x78, 1, 1, 3, 0, 0xfc, 0xff, 0, value >> 8, value & 0xff, 0, 0, 0, 0});
    return "\x89PNG\r\n\x1a\n" + chunk("IHDR", bytes({0, 0, 0, 1, 0, 0, 0, 1, 16, 0, 0, 0, 0})) +
           chunk("IDAT", deflated) + chunk("IEND", "");
}

/// Red and green above blue and grey.
inline std::string four_colors() {
    return png(2, 2, {Red, Green, Blue, Gray});
}

} // namespace relumine::mesh
