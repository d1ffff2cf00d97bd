// The fields of a TIFF file's first picture. Based on: Adobe, TIFF Revision 6.0, 1992; the BigTIFF
// page of libtiff.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "cubemap/image/file_bytes.h"

namespace relumine::cubemap::tiff {

enum Tag : std::uint16_t {
    Width = 256,
    Height = 257,
    BitsPerSample = 258,
    Compression = 259,
    Photometric = 262,
    StripOffsets = 273,
    Orientation = 274,
    SamplesPerPixel = 277,
    RowsPerStrip = 278,
    StripByteCounts = 279,
    Planar = 284,
    Predictor = 317,
    WhitePoint = 318,
    PrimaryColors = 319,
    TileWidth = 322,
    TileLength = 323,
    TileOffsets = 324,
    TileByteCounts = 325,
    ExtraSamples = 338,
    SampleFormat = 339,
    IccProfile = 34675,
};

/// The fields of the first picture. Others, smaller ones or pages, are not read. What is absent or
/// of an unknown type has no numbers.
class Directory {
public:
    /// Keeps `file`. Throws as FileBytes::refuse() for fields that do not lie in the file.
    explicit Directory(const FileBytes& file);

    [[nodiscard]] bool is_big_endian() const { return is_big_endian_; }
    [[nodiscard]] bool has(Tag tag) const { return fields_.contains(tag); }

    /// Returns the whole numbers of a field; none where it is absent.
    [[nodiscard]] std::vector<std::uint64_t> numbers(Tag tag) const;
    [[nodiscard]] std::uint64_t number(Tag tag, std::uint64_t otherwise) const;
    /// Returns the rational numbers of a field.
    [[nodiscard]] std::vector<double> fractions(Tag tag) const;
    /// Returns a field as it stands in the file.
    [[nodiscard]] std::vector<std::byte> bytes_of(Tag tag) const;

private:
    struct Field {
        std::uint16_t type;
        std::uint64_t count, value_at, offset;
    };

    const FileBytes& file_;
    bool is_big_endian_ = false, is_big_tiff_ = false;
    std::map<std::uint16_t, Field> fields_;
};

} // namespace relumine::cubemap::tiff
