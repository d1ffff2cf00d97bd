// Decodes PNG, JPEG, WebP, BMP and TGA files to bytes of RGB. The only user of stb_image;
// files/jpeg_decoder.h decodes JPEG. The only user of libwebp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace relumine::mesh {

/// The longest edge of an image.
inline constexpr std::uint32_t MaxImageEdge = 16384;
class ImageBudget;

enum class ImageFormat : std::uint8_t { Png, Jpeg, WebP, Avif, Bmp, Tga };

/// Returns the format by the file's first bytes. TGA files have no mark, so a file with no other
/// mark counts as TGA.
[[nodiscard]] ImageFormat image_format(std::span<const std::byte> file);

/// A decoded image.
struct DecodedImage {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    /// [height * width * 3] from the top left; decode_alpha(): [height * width].
    std::unique_ptr<std::uint8_t, void (*)(void*)> bytes{nullptr, nullptr};
};

/// Decodes an image. Grey becomes RGB, alpha is dropped, 16 bits become 8. The size that the header
/// declares is checked against the file's size and the budget before memory is allocated.
/// Throws:  std::runtime_error "expected X, got Y".
[[nodiscard]] DecodedImage decode_image(std::span<const std::byte> file, ImageBudget& budget);

/// Decodes the alpha of an image: 255 everywhere if it has none. A JPEG never has any, and gives
/// one pixel.
///
/// Throws:  as decode_image().
[[nodiscard]] DecodedImage decode_alpha(std::span<const std::byte> file, ImageBudget& budget);

} // namespace relumine::mesh
