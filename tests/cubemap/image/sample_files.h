// Small files that other programs wrote, and what is in them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/image/image_file.h"
#include "files/output_file.h"

namespace relumine::cubemap {

/// Returns a file's path below tests/fuzz/corpus.
inline std::filesystem::path sample(const std::string& name) {
    return std::filesystem::path(RELUMINE_SAMPLES) / name;
}

inline std::vector<std::filesystem::path> samples(const std::string& folder) {
    std::vector<std::filesystem::path> result;
    for (const auto& entry : std::filesystem::directory_iterator(sample(folder)))
        result.push_back(entry.path());
    std::sort(result.begin(), result.end());
    return result;
}

inline ImageFile decode_file(const std::filesystem::path& path) {
    const std::vector<std::byte> bytes = files::read(path);
    return format_of(bytes, path).decode(bytes, path.filename().string());
}

inline std::vector<std::byte> bytes_of_text(const std::string& text) {
    std::vector<std::byte> bytes(text.size());
    for (std::size_t i = 0; i < text.size(); ++i)
        bytes[i] = static_cast<std::byte>(text[i]);
    return bytes;
}

inline ImageFile decode_text(const std::string& text, const std::string& name) {
    const std::vector<std::byte> bytes = bytes_of_text(text);
    return format_of(bytes, name).decode(bytes, name);
}

/// The lat-long of 8 x 4 pixels that all samples of TIFF and PFM show.
inline std::vector<glm::vec3> ramp() {
    std::vector<glm::vec3> pixels;
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 8; ++x)
            pixels.emplace_back(x + 1, 256 * (y + 1), std::ldexp(1.0f, -x - y));
    return pixels;
}

} // namespace relumine::cubemap
