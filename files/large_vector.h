// Vectors of many megabytes.
#pragma once

#include <cstddef>
#include <type_traits>
#include <vector>

namespace relumine::files {

/// Asks the system for the pages of memory that is to be written, on all threads at once. Else each
/// page is a fault of its own when it is written first, which takes longer than what is written.
/// Does nothing for less than some MB, and where the system cannot.
void take_pages(void* memory, std::size_t size);

/// Returns std::vector(size, value).
template<typename Element>
[[nodiscard]] std::vector<Element> large_vector(std::size_t size,
                                                const Element& value = Element()) {
    static_assert(std::is_trivially_copyable_v<Element>);
    std::vector<Element> result;
    result.reserve(size);
    take_pages(result.data(), size * sizeof(Element));
    result.resize(size, value);
    return result;
}

} // namespace relumine::files
