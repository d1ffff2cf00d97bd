// gzip, which browsers unpack.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace relumine::files {

/// Returns a .gz file in memory; equal bytes give equal files.
/// Throws:  std::runtime_error if zlib fails.
[[nodiscard]] std::vector<std::byte> gzipped(std::span<const std::byte> bytes);

} // namespace relumine::files
