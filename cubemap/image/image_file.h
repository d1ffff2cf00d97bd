// What the readers of both file formats return to load_environment().
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
#include "files/output_file.h"

namespace relumine::cubemap {

/// The content of a decoded file. An alpha channel is not read.
struct ImageFile : Picture {
    /// The layout that the file itself states by OpenEXR's `envmap` attribute. Empty: none stated.
    std::optional<Layout> envmap;
    /// What a user may want to know, for example "luminance only".
    std::vector<std::string> remarks;
};

/// More pixels than any environment has: a cube of 6 x 9459^2. A larger file is refused as damaged
/// before memory is allocated.
inline constexpr std::uint64_t MaxPixels = std::uint64_t{1} << 29;

/// Returns true if a file's first bytes mark it as .exr or .hdr.
[[nodiscard]] bool is_exr(std::span<const std::byte> bytes);
[[nodiscard]] bool is_hdr(std::span<const std::byte> bytes);

/// Decodes a file's content. `name` stands for the file in messages.
/// Throws:  std::runtime_error "name: expected X, got Y".
[[nodiscard]] ImageFile decode_exr(std::span<const std::byte> bytes, const std::string& name);
[[nodiscard]] ImageFile decode_hdr(std::span<const std::byte> bytes, const std::string& name);

/// Returns the size that decode_exr() would find, from the header alone.
[[nodiscard]] ImageSize exr_size(const std::filesystem::path& path);
/// Returns the size that decode_hdr() would find. `head` holds the first bytes of a file of
/// `num_bytes`.
[[nodiscard]] ImageSize hdr_size(std::span<const std::byte> head, std::size_t num_bytes,
                                 const std::string& name);

/// Pixels that stand beside a picture in its file.
struct ExrLayer {
    /// Without a dot, and different from all others.
    std::string name;
    /// [number of the picture's pixels] in the picture's order.
    std::span<const glm::vec3> pixels;
};

/// Returns an .exr file: 32-bit float RGB, ZIP. The `envmap` attribute is set if samples lie on the
/// borders. The file has a channel A if the picture has alpha, and three channels NAME.R, NAME.G,
/// NAME.B for each layer.
[[nodiscard]] std::vector<std::byte> encode_exr(const EnvironmentImage& image,
                                                std::span<const ExrLayer> layers = {});
/// Adds the same bytes to an empty file. They are written while others are compressed.
/// Throws:  as files::OutputFile::write().
void write_exr(files::OutputFile& file, const EnvironmentImage& image,
               std::span<const ExrLayer> layers = {});
/// Returns an .hdr file: RGBE, run-length encoded, rounded to nearest.
/// Throws:  std::invalid_argument for radiance that RGBE cannot hold.
[[nodiscard]] std::vector<std::byte> encode_hdr(const EnvironmentImage& image);

} // namespace relumine::cubemap
