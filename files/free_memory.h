// How much memory a program may still take.
#pragma once

#include <cstdint>

namespace relumine::files {

/// Returns the bytes that the system can give without swapping, at most what the limit of the
/// process's address space (ulimit -v) leaves.
[[nodiscard]] std::uint64_t free_memory();

} // namespace relumine::files
