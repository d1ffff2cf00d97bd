// Large arrays of the program lie in huge pages, where the system has them for those who ask.
//
// A scene and an environment are some arrays of many megabytes, and Linux fills each page with
// zeros when it is first written to. With pages of 4 KiB that takes longer than to unpack a scene:
// `relumine relight` of the Stanford bunny takes 0.40 s with them and 0.26 s with pages of 2 MiB.
// (docs/performance.md.)
//
// This replaces the allocation of the whole program, which a library must not do.
#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <new>

#include <sys/mman.h>

namespace {

constexpr std::size_t HugePage = std::size_t{1} << 21;
/// Smaller arrays may share their pages with others.
constexpr std::size_t LargeArray = 2 * HugePage;

void* allocate(std::size_t size, std::size_t alignment) {
    const bool is_large = size >= LargeArray;
    if (is_large)
        alignment = std::max(alignment, HugePage);
    size = std::max(size, std::size_t{1});
    for (;;) {
        void* const memory = alignment <= alignof(std::max_align_t)
                                 ? std::malloc(size)
                                 : std::aligned_alloc(alignment, size);
        if (memory != nullptr) {
            // The rest of the array has small pages, so that it takes no more memory than it needs.
            // A system without huge pages refuses, and nothing is lost.
            if (is_large)
                static_cast<void>(madvise(memory, size & ~(HugePage - 1), MADV_HUGEPAGE));
            return memory;
        }
        const std::new_handler handler = std::get_new_handler();
        if (handler == nullptr)
            throw std::bad_alloc();
        handler();
    }
}

} // namespace

void* operator new(std::size_t size) {
    return allocate(size, alignof(std::max_align_t));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    return allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}
