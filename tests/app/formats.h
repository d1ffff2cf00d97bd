// What a test can tell of an output file without the program's own readers.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace relumine::app {

struct Size {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    bool operator==(const Size&) const = default;
};

/// All of these throw std::runtime_error where the bytes are not such a file.
[[nodiscard]] std::vector<std::array<float, 3>> npy_values(const std::string& bytes);
[[nodiscard]] Size png_size(const std::string& bytes);
[[nodiscard]] Size exr_size(const std::string& bytes);
/// The channels of an OpenEXR file of 32-bit floats, by name, row by row.
[[nodiscard]] std::map<std::string, std::vector<float>>
exr_channels(const std::filesystem::path& path);
/// The JSON chunk of binary glTF.
[[nodiscard]] nlohmann::json glb_json(const std::string& bytes);
/// The count of an element in a binary little-endian PLY header.
[[nodiscard]] std::size_t ply_element(const std::string& bytes, const std::string& name);

/// ||a - b|| / ||b||, over all values.
[[nodiscard]] double relative_l2(const std::vector<std::array<float, 3>>& a,
                                 const std::vector<std::array<float, 3>>& b);

} // namespace relumine::app
