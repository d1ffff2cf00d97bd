// zstd, as scene files and checkpoints use it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace relumine::files {

/// What says that it is larger than this for its bytes was not made here (zstd reaches some 30,000
/// : 1).
inline constexpr std::uint64_t MaxCompressionRatio = 1 << 17;

/// One frame, which says its own size. Throws std::runtime_error when zstd fails.
[[nodiscard]] std::vector<std::byte> compressed(std::span<const std::byte> bytes, int level);

} // namespace relumine::files
