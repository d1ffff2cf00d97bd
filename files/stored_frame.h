// zstd frames whose bytes are stored as they are. Every reader of zstd data reads them, and a
// reader of nothing else is short.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace relumine::files {

/// What such a frame has beside its bytes (RFC 8878).
struct StoredFrame {
    static constexpr std::uint32_t Magic = 0xFD2FB528;
    /// A size of 8 bytes follows; the whole content is one window.
    static constexpr std::uint8_t Descriptor = 0xE0;
    static constexpr std::size_t HeaderSize = 13;
    static constexpr std::size_t BlockHeaderSize = 3;
    static constexpr std::size_t BlockSize = std::size_t{1} << 17;
};

/// Returns the size of a frame of `size` bytes.
[[nodiscard]] std::size_t stored_frame_size(std::size_t size);

/// Returns a frame of these bytes.
[[nodiscard]] std::vector<std::byte> stored_frame(std::span<const std::byte> bytes);

} // namespace relumine::files
