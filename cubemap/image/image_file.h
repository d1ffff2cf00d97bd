// What the readers of both file formats hand to load_environment().
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/image/environment.h"

namespace relumine::cubemap {

/// A decoded file. An alpha channel is not read.
struct ImageFile : Picture {
    /// The layout that the file itself states (OpenEXR's `envmap` attribute)
    std::optional<Layout> envmap;
    /// What a user may want to know, e.g. "luminance only"
    std::vector<std::string> remarks;
};

/// More pixels than any environment has (a cube of 6 x 9459^2); beyond it a file is taken for
/// damaged before memory is allocated.
inline constexpr std::uint64_t MaxPixels = std::uint64_t{1} << 29;

[[nodiscard]] bool is_exr(std::span<const std::byte> bytes);
[[nodiscard]] bool is_hdr(std::span<const std::byte> bytes);

/// Decode a file's content. `name` stands for it in messages: std::runtime_error "name: expected X,
/// got Y".
[[nodiscard]] ImageFile decode_exr(std::span<const std::byte> bytes, const std::string& name);
[[nodiscard]] ImageFile decode_hdr(std::span<const std::byte> bytes, const std::string& name);

/// The size of the image that they would decode, from the header alone.
[[nodiscard]] ImageSize exr_size(const std::filesystem::path& path);
/// `head`: the file's first bytes, of `num_bytes` that it has.
[[nodiscard]] ImageSize hdr_size(std::span<const std::byte> head, std::size_t num_bytes,
                                 const std::string& name);

/// 32-bit float RGB, ZIP, with the `envmap` attribute where the samples lie on the borders, and a
/// channel A where the picture has alpha.
[[nodiscard]] std::vector<std::byte> encode_exr(const EnvironmentImage& image);
/// RGBE, run-length encoded, rounded to nearest. Throws std::invalid_argument for radiance that
/// RGBE cannot hold.
[[nodiscard]] std::vector<std::byte> encode_hdr(const EnvironmentImage& image);

} // namespace relumine::cubemap
