// Whole numbers, most of them small, as sections store them: numbers below 2^7 take a byte, below
// 2^14 two, and so on. Seven bits a byte, the lowest first; the eighth is set where more follow.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
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

/// Returns the number at `bytes[at]` and moves `at` behind it, or nothing where it has no end
/// within nine bytes.
inline std::optional<std::uint64_t> next_small(std::span<const std::byte> bytes, std::size_t& at) {
    std::uint64_t number = 0;
    for (std::uint32_t shift = 0; shift < 63 && at < bytes.size(); shift += 7) {
        const auto byte = std::to_integer<std::uint64_t>(bytes[at++]);
        number |= (byte & 0x7fu) << shift;
        if (byte < 0x80u)
            return number;
    }
    return std::nullopt;
}

/// Reads the numbers of a section one after the other.
class SmallNumbers {
public:
    /// `expected` is what the section should hold, for the message where it does not.
    SmallNumbers(const SectionReader& reader, std::string section, std::string_view expected)
        : reader_(reader), section_(std::move(section)), expected_(expected),
          bytes_(reader.bytes(section_)) {}

    std::uint64_t next() {
        if (const std::optional<std::uint64_t> number = next_small(bytes_, at_))
            return *number;
        reader_.fail(section_, expected_);
    }
    [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }

private:
    const SectionReader& reader_;
    std::string section_, expected_;
    std::vector<std::byte> bytes_;
    std::size_t at_ = 0;
};

/// Where numbers begin in pieces of a megabyte, so that many threads can read them.
class NumberPieces {
public:
    struct Place {
        std::size_t byte = 0;
        /// Numbers before it.
        std::uint64_t number = 0;
    };

    /// The bytes must outlive the pieces.
    explicit NumberPieces(std::span<const std::byte> bytes);

    [[nodiscard]] std::size_t size() const { return begins_.size() - 1; }
    /// Returns where the first number of a piece begins; for size(), the end of all.
    [[nodiscard]] const Place& begin(std::size_t piece) const { return begins_[piece]; }
    [[nodiscard]] std::uint64_t num_numbers() const { return begins_.back().number; }
    /// Whether the last number has its end.
    [[nodiscard]] bool are_whole() const { return bytes_.empty() || is_end(bytes_.back()); }

    /// Goes on by so many numbers, or to the end.
    void skip(std::uint64_t count, Place& at) const;
    /// Returns the number here and goes on to the next; nothing as next_small() does.
    [[nodiscard]] std::optional<std::uint64_t> next(Place& at) const {
        ++at.number;
        return next_small(bytes_, at.byte);
    }

private:
    static bool is_end(std::byte byte) { return (byte & std::byte{0x80}) == std::byte{0}; }

    std::span<const std::byte> bytes_;
    /// [size() + 1]
    std::vector<Place> begins_;
};

} // namespace relumine::prt
