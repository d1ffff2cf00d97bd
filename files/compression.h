// zstd compression for scene files and checkpoints.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace relumine::files {

/// Largest ratio of declared size to compressed bytes that a reader accepts. Our files stay below
/// it: zstd reaches about 30,000 : 1.
inline constexpr std::uint64_t MaxCompressionRatio = 1 << 17;

/// Returns one zstd frame that states its own size.
/// Throws:  std::runtime_error if zstd fails.
[[nodiscard]] std::vector<std::byte> compressed(std::span<const std::byte> bytes, int level);

/// Unpacks frames of zstd that hold just as many bytes as `to` has. Returns false for others.
[[nodiscard]] bool decompress(std::span<const std::byte> from, std::span<std::byte> to);

} // namespace relumine::files
