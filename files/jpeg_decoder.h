// Decodes JPEG files to bytes of RGB. The only user of libjpeg.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

namespace relumine::files {

/// Decodes into the memory that `allocate(width, height)` returns, [height * width * 3] from the
/// top left. `allocate` may throw to refuse the size. Grey becomes RGB. CMYK is taken as inverted,
/// as Adobe's programs write it.
/// Throws:  std::runtime_error "expected X, got Y" for a file that is broken in any way, ends
///          early, or has more than 100 scans (each costs a pass over the picture).
void decode_jpeg(
    std::span<const std::byte> file,
    const std::function<std::uint8_t*(std::uint32_t width, std::uint32_t height)>& allocate);

} // namespace relumine::files
