// Bands of rows are filtered and compressed in parallel. Each band ends at a whole byte, so the
// bands of deflate data follow each other in one stream (as pigz does it).
//
// Source:  PNG specification (third edition), RFC 1950.
#include "relight/pictures/png_file.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <new>

#include <zlib.h>

#include "files/parallel.h"

namespace relumine::relight {

namespace {

constexpr std::uint32_t RowsPerBand = 64;

void append_number(std::vector<std::byte>& out, std::uint32_t value) {
    for (const int shift : {24, 16, 8, 0})
        out.push_back(static_cast<std::byte>(value >> shift));
}

void append_chunk(std::vector<std::byte>& png, const std::array<char, 4>& type,
                  std::span<const std::byte> data) {
    append_number(png, static_cast<std::uint32_t>(data.size()));
    const std::size_t start = png.size();
    for (const char letter : type)
        png.push_back(static_cast<std::byte>(letter));
    png.insert(png.end(), data.begin(), data.end());
    const uLong sum =
        ::crc32_z(0, reinterpret_cast<const Bytef*>(png.data() + start), png.size() - start);
    append_number(png, static_cast<std::uint32_t>(sum));
}

int paeth(int left, int above, int corner) {
    const int to_left = std::abs(above - corner), to_above = std::abs(left - corner),
              to_corner = std::abs(left + above - 2 * corner);
    return to_left <= to_above && to_left <= to_corner ? left
           : to_above <= to_corner                     ? above
                                                       : corner;
}

/// The filters of a row, with buffers for the differences.
struct Filters {
    static constexpr std::array<std::uint8_t, 3> Types = {1, 2, 4}; // Sub, Up, Paeth
    std::array<std::vector<std::uint8_t>, 3> differences;
    /// In place of a row before the first one.
    std::vector<std::uint8_t> zeros;
};

/// Appends a filtered row: of the filters the one with the smallest sum of differences.
void append_row(std::span<const std::uint8_t> row, std::span<const std::uint8_t> before,
                std::size_t num_channels, Filters& filters, std::vector<std::uint8_t>& out) {
    const std::size_t n = row.size();
    for (auto& each : filters.differences)
        each.resize(n);
    auto& [sub, up, both] = filters.differences;
    const auto difference = [](int value, int guess) {
        return static_cast<std::uint8_t>(value - guess);
    };
    for (std::size_t i = 0; i < num_channels; ++i) {
        sub[i] = row[i];
        both[i] = difference(row[i], before[i]);
    }
    for (std::size_t i = 0; i < n; ++i)
        up[i] = difference(row[i], before[i]);
    for (std::size_t i = num_channels; i < n; ++i)
        sub[i] = difference(row[i], row[i - num_channels]);
    for (std::size_t i = num_channels; i < n; ++i)
        both[i] =
            difference(row[i], paeth(row[i - num_channels], before[i], before[i - num_channels]));
    std::size_t best = 0;
    std::uint32_t least = ~std::uint32_t{0};
    for (std::size_t k = 0; k < Filters::Types.size(); ++k) {
        std::uint32_t sum = 0; // of up to 2^24 bytes of at most 128
        for (const std::uint8_t value : filters.differences[k])
            sum += std::min<std::uint32_t>(value, 256U - value);
        if (sum < least) {
            least = sum;
            best = k;
        }
    }
    out.push_back(Filters::Types[best]);
    out.insert(out.end(), filters.differences[best].begin(), filters.differences[best].end());
}

std::vector<std::byte> deflated(std::span<const std::uint8_t> data, bool is_last) {
    constexpr int Level = 3, WindowBits = 15, Memory = 8;
    z_stream stream{};
    if (::deflateInit2(&stream, Level, Z_DEFLATED, -WindowBits, Memory, Z_FILTERED) != Z_OK)
        throw std::bad_alloc();
    // The end of a band may need a few bytes more than deflateBound() says.
    std::vector<std::byte> out(::deflateBound(&stream, static_cast<uLong>(data.size())) + 64);
    stream.next_in = const_cast<Bytef*>(data.data());
    stream.avail_in = static_cast<uInt>(data.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    ::deflate(&stream, is_last ? Z_FINISH : Z_SYNC_FLUSH);
    out.resize(out.size() - stream.avail_out);
    ::deflateEnd(&stream);
    return out;
}

} // namespace

std::vector<std::byte> encode_png(std::uint32_t width, std::uint32_t height,
                                  std::size_t num_channels, std::span<const std::uint8_t> bytes) {
    const std::size_t row_size = width * num_channels;
    struct Band {
        std::vector<std::byte> data;
        uLong sum = 1;
        std::size_t size = 0;
    };
    std::vector<Band> bands((height + RowsPerBand - 1) / RowsPerBand);
    files::parallel_for(std::size_t{0}, bands.size(), [&](std::size_t band) {
        const std::size_t first = band * RowsPerBand;
        const std::size_t end = std::min<std::size_t>(first + RowsPerBand, height);
        Filters filters;
        filters.zeros.assign(row_size, 0);
        std::vector<std::uint8_t> filtered;
        filtered.reserve((end - first) * (row_size + 1));
        for (std::size_t y = first; y < end; ++y)
            append_row(bytes.subspan(y * row_size, row_size),
                       y == 0 ? std::span<const std::uint8_t>(filters.zeros)
                              : bytes.subspan((y - 1) * row_size, row_size),
                       num_channels, filters, filtered);
        bands[band] = {deflated(filtered, end == height),
                       ::adler32_z(1, filtered.data(), filtered.size()), filtered.size()};
    });

    std::vector<std::byte> data = {std::byte{0x78}, std::byte{0x9c}}; // deflate, window of 32 kB
    uLong sum = 1;
    for (const Band& band : bands) {
        data.insert(data.end(), band.data.begin(), band.data.end());
        sum = ::adler32_combine(sum, band.sum, static_cast<z_off_t>(band.size));
    }
    append_number(data, static_cast<std::uint32_t>(sum));

    std::vector<std::byte> png;
    for (const int byte : {0x89, 'P' + 0, 'N' + 0, 'G' + 0, 0x0d, 0x0a, 0x1a, 0x0a})
        png.push_back(static_cast<std::byte>(byte));
    std::vector<std::byte> header;
    append_number(header, width);
    append_number(header, height);
    // Bit depth, colour type, and the only compression, filter method and no interlace.
    for (const int byte : {8, num_channels == 4 ? 6 : 2, 0, 0, 0})
        header.push_back(static_cast<std::byte>(byte));
    append_chunk(png, {'I', 'H', 'D', 'R'}, header);
    // A chunk's size has 31 bits.
    constexpr std::size_t LargestChunk = std::size_t{1} << 30;
    for (std::size_t start = 0; start < data.size(); start += LargestChunk)
        append_chunk(png, {'I', 'D', 'A', 'T'},
                     std::span(data).subspan(start, std::min(LargestChunk, data.size() - start)));
    append_chunk(png, {'I', 'E', 'N', 'D'}, {});
    return png;
}

} // namespace relumine::relight
