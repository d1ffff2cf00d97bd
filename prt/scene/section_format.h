// What a file of sections looks like: docs/prt-format.md.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>

namespace relumine::prt {

/// The version that is written, and the only one that is read.
inline constexpr std::uint32_t SceneFileVersion = 5;

// The file's structures are memory images. A big-endian reader would have to swap them.
static_assert(std::endian::native == std::endian::little, ".prt files are little-endian");

struct SectionFileHeader {
    static constexpr std::array<char, 8> Magic = {'R', 'E', 'L', 'U', 'M', 'I', 'N', 'E'};
    static constexpr std::uint32_t ByteOrderMark = 0x01020304;
    static constexpr std::uint32_t MaxSections = 128;

    std::array<char, 8> magic = Magic;
    std::uint32_t byte_order_mark = ByteOrderMark;
    std::uint32_t version = SceneFileVersion;
    std::uint64_t file_size = 0;
    std::uint32_t num_sections = 0;
    std::uint32_t reserved = 0;
    /// xxHash64 of the header up to here and of the section table.
    std::uint64_t checksum = 0;
};
static_assert(sizeof(SectionFileHeader) == 40);

struct SectionEntry {
    /// Padded with zeros.
    std::array<char, 16> name = {};
    /// From the start of the file.
    std::uint64_t offset = 0;
    /// Compressed.
    std::uint64_t stored_size = 0;
    /// Uncompressed.
    std::uint64_t size = 0;
    /// xxHash64 of the stored bytes.
    std::uint64_t checksum = 0;
};
static_assert(sizeof(SectionEntry) == 48);

/// Returns what the header's checksum should be.
[[nodiscard]] std::uint64_t table_checksum(const SectionFileHeader& header,
                                           std::span<const SectionEntry> table);

} // namespace relumine::prt
