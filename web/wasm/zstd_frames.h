// Unpacks zstd frames (RFC 8878). Debian has libzstd for its own processors alone, so the
// WebAssembly module has this reader. It knows no dictionaries, which scene files do not have.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace relumine::web {

using Bytes = std::span<const std::uint8_t>;

/// Thrown for bytes that are no zstd frame.
struct NoFrame {};

/// Returns how many bytes the first frame takes, without unpacking it; nothing where more bytes are
/// needed.
///
/// Throws:  NoFrame.
[[nodiscard]] std::optional<std::size_t> frame_size(Bytes bytes);

/// Returns the size that the first frame says its content has; nothing where it does not say so.
///
/// Throws:  NoFrame.
[[nodiscard]] std::optional<std::uint64_t> content_size(Bytes bytes);

/// Unpacks one frame, and checks its checksum where it has one. Returns the size of its content.
///
/// Throws:  NoFrame, also where the content is larger than `to`.
std::size_t unpack_frame(Bytes frame, std::span<std::uint8_t> to);

} // namespace relumine::web
