// Decodes WebP files to bytes of RGB or RGBA. The only user of libwebp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

namespace relumine::mesh {

/// Decodes into the memory that `allocate(width, height)` returns, [height * width * 3], or 4 with
/// alpha, from the top left. `allocate` may throw to refuse the size.
/// Throws:  std::runtime_error "expected X, got Y" for a file that is broken in any way, ends
///          early, or is an animation.
void decode_webp(
    std::span<const std::byte> file, bool with_alpha,
    const std::function<std::uint8_t*(std::uint32_t width, std::uint32_t height)>& allocate);

} // namespace relumine::mesh
