// Stands in the place of files/free_memory.cpp, which asks the system.
#include "files/free_memory.h"

namespace relumine::files {

/// What the module's memory may grow by (CMakeLists.txt: MAXIMUM_MEMORY).
std::uint64_t free_memory() {
    constexpr std::uint64_t MostMemory = std::uint64_t{1} << 32, PageSize = std::uint64_t{1} << 16;
    return MostMemory - __builtin_wasm_memory_size(0) * PageSize;
}

} // namespace relumine::files
