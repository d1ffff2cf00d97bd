#include "files/large_vector.h"

#include <cstdint>

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include "files/parallel.h"

namespace relumine::files {

#if defined(MADV_POPULATE_WRITE)

void take_pages(void* memory, std::size_t size) {
    constexpr std::size_t Least = std::size_t{4} << 20, Page = 4096, Piece = std::size_t{1} << 20;
    if (size < Least)
        return;
    const auto address = reinterpret_cast<std::uintptr_t>(memory);
    const std::size_t before = (Page - address % Page) % Page;
    char* const first = static_cast<char*>(memory) + before;
    const std::size_t num_pages = (size - before) / Page;
    parallel_for(IndexRange<std::size_t>(0, num_pages, Piece / Page),
                 [first](const IndexRange<std::size_t>& pages) {
                     // An older system refuses: then pages come when they are written.
                     static_cast<void>(::madvise(first + pages.begin() * Page, pages.size() * Page,
                                                 MADV_POPULATE_WRITE));
                 });
}

#else

void take_pages(void*, std::size_t) {}

#endif

} // namespace relumine::files
