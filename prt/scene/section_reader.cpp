#include "prt/scene/section_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>

#include "prt/scene/json_members.h"

namespace relumine::prt {

std::vector<std::byte> bytes_of(std::string_view text) {
    const std::span<const std::byte> bytes = std::as_bytes(std::span(text.data(), text.size()));
    return {bytes.begin(), bytes.end()};
}

std::vector<std::byte> packed(const std::vector<bool>& flags) {
    std::vector<std::byte> bytes((flags.size() + 7) / 8);
    for (std::size_t i = 0; i < flags.size(); ++i)
        bytes[i / 8] |= static_cast<std::byte>(static_cast<unsigned>(flags[i]) << (i % 8));
    return bytes;
}

std::vector<bool> unpacked(std::span<const std::byte> bytes, std::size_t count) {
    if (bytes.size() != count / 8 + static_cast<std::size_t>(count % 8 != 0) ||
        (count % 8 != 0 && (bytes.back() >> (count % 8)) != std::byte{0}))
        throw std::length_error("expected as many bits");
    std::vector<bool> flags(count);
    for (std::size_t i = 0; i < count; ++i)
        flags[i] = (bytes[i / 8] >> (i % 8) & std::byte{1}) != std::byte{0};
    return flags;
}

void SectionReader::fail(std::string_view section, std::string_view expected) const {
    throw std::runtime_error(fmt::format("{}: expected {}, got a damaged section '{}'",
                                         path().string(), expected, section));
}

files::Json SectionReader::json(const std::string& name) const {
    constexpr std::uint64_t MemoryPerByte = 32; // "0," becomes a value
    const std::vector<std::byte> text = bytes(name, MemoryPerByte);
    // A zero ends a text for the JSON library.
    if (std::find(text.begin(), text.end(), std::byte{0}) != text.end())
        fail(name, "JSON text");
    try {
        return files::parse_json({reinterpret_cast<const char*>(text.data()), text.size()});
    } catch (const files::JsonError&) {
        fail(name, "JSON text");
    }
}

std::vector<bool> SectionReader::bits(const std::string& name, std::size_t count) const {
    try {
        return unpacked(bytes(name), count);
    } catch (const std::length_error&) {
        fail(name, fmt::format("{} bits", count));
    }
}

std::uint32_t natural(const files::Json& json) {
    if (json.whole() > std::numeric_limits<std::uint32_t>::max())
        throw std::out_of_range("expected an integer of 32 bits");
    return static_cast<std::uint32_t>(json.whole());
}

float real(const files::Json& json) {
    if (!(std::abs(json.number()) <= std::numeric_limits<float>::max()))
        throw std::out_of_range("expected a number that a float holds");
    return static_cast<float>(json.number());
}

} // namespace relumine::prt
