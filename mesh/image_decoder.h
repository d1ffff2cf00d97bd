// PNG, JPEG, BMP and TGA files as bytes of RGB. The only user of stb_image; jpeg_decoder.h does
// JPEG.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace relumine::mesh {

/// No image has a longer edge.
inline constexpr std::uint32_t MaxImageEdge = 16384;
/// Images of more pixels than this need a file of at least a byte for 128 of them: a hostile one of
/// kilobytes must not cost gigabytes.
inline constexpr std::uint64_t MaxCheapPixels = std::uint64_t{1} << 26;

struct DecodedImage {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::unique_ptr<std::uint8_t, void (*)(void*)> rgb{nullptr,
                                                       /// [height * width * 3] from the top left
                                                       nullptr};
};

/// Grey becomes RGB, alpha is dropped, 16 bits become 8. What the header declares is held against
/// the file's size before memory is allocated. Throws std::runtime_error "expected X, got Y".
[[nodiscard]] DecodedImage decode_image(std::span<const std::byte> file);

} // namespace relumine::mesh
