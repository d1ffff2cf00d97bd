// Whole numbers, most of them small, as sections store them: numbers below 2^7 take a byte, below
// 2^14 two, and so on. Seven bits a byte, the lowest first; the eighth is set where more follow.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "prt/scene/section_reader.h"

namespace relumine::prt {

inline void append_small(std::vector<std::uint8_t>& bytes, std::uint64_t number) {
    for (; number >= 0x80u; number >>= 7u)
        bytes.push_back(static_cast<std::uint8_t>(number | 0x80u));
    bytes.push_back(static_cast<std::uint8_t>(number));
}

/// Reads the numbers of a section one after the other.
class SmallNumbers {
public:
    /// `expected` is what the section should hold, for the message where it does not.
    SmallNumbers(const SectionReader& reader, std::string section, std::string_view expected)
        : reader_(reader), section_(std::move(section)), expected_(expected),
          bytes_(reader.bytes(section_)) {}

    std::uint64_t next() {
        std::uint64_t number = 0;
        for (std::uint32_t shift = 0; shift < 63 && at_ < bytes_.size(); shift += 7) {
            const auto byte = std::to_integer<std::uint64_t>(bytes_[at_++]);
            number |= (byte & 0x7fu) << shift;
            if (byte < 0x80u)
                return number;
        }
        reader_.fail(section_, expected_);
    }
    [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }
    /// Bytes of the section, at least as many as numbers.
    [[nodiscard]] std::size_t size() const { return bytes_.size(); }

private:
    const SectionReader& reader_;
    std::string section_, expected_;
    std::vector<std::byte> bytes_;
    std::size_t at_ = 0;
};

} // namespace relumine::prt
