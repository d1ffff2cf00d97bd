// Takes the sections of a .prt file apart into typed arrays.
#pragma once

#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "files/json.h"
#include "files/large_vector.h"
#include "prt/scene/packed_sections.h"
#include "prt/scene/section_file.h"

namespace relumine::prt {

/// Returns an array as a section stores it. For an array that lasts until the section is written,
/// SectionContent::view() needs no memory.
template<typename Element>
[[nodiscard]] std::vector<std::byte> bytes_of(const std::vector<Element>& elements) {
    static_assert(std::is_trivially_copyable_v<Element>);
    std::vector<std::byte> bytes(elements.size() * sizeof(Element));
    if (!elements.empty())
        std::memcpy(bytes.data(), elements.data(), bytes.size());
    return bytes;
}

/// Returns a text as a section stores it.
[[nodiscard]] std::vector<std::byte> bytes_of(std::string_view text);

/// Packs split flags or masks, eight to a byte, lowest bit first.
[[nodiscard]] std::vector<std::byte> packed(const std::vector<bool>& flags);

/// Undoes packed().
/// Throws:  std::length_error for bytes of another size, and for bits behind the last.
[[nodiscard]] std::vector<bool> unpacked(std::span<const std::byte> bytes, std::size_t count);

/// The sections of a file as arrays. Every message names the file and the section.
class SectionReader : public PackedSections {
public:
    using PackedSections::PackedSections;

    [[noreturn]] void fail(std::string_view section, std::string_view expected) const;

    /// Returns all elements of a section.
    template<typename Element>
    [[nodiscard]] std::vector<Element> elements(const std::string& name) const {
        std::vector<Element> result;
        unpack(name, 1, [&](std::size_t size) {
            if (size % sizeof(Element) != 0)
                fail(name, fmt::format("a multiple of {} bytes", sizeof(Element)));
            result = files::large_vector<Element>(size / sizeof(Element));
            return std::as_writable_bytes(std::span(result));
        });
        return result;
    }

    /// Returns exactly `count` elements, or none where an optional section is absent.
    template<typename Element>
    [[nodiscard]] std::vector<Element> elements(const std::string& name, std::size_t count,
                                                bool optional = false) const {
        if (optional && !has(name))
            return {};
        std::vector<Element> result = elements<Element>(name);
        if (result.size() != count)
            fail(name, fmt::format("{} elements", count));
        return result;
    }

    /// Parses a section of JSON text. Fails for other text, and for zero bytes.
    [[nodiscard]] files::Json json(const std::string& name) const;

    /// Returns exactly `count` bits. The rest of the last byte must be zero.
    [[nodiscard]] std::vector<bool> bits(const std::string& name, std::size_t count) const;
};

} // namespace relumine::prt
