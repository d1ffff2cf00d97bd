#include "cubemap/image/tiff_packing.h"

#include <algorithm>
#include <new>
#include <vector>

#include <libdeflate.h>

#include "files/compression.h"

namespace relumine::cubemap::tiff {

namespace {

/// Unpacks TIFF's LZW: codes of 9 to 12 bits, the highest bit first, which grow one code early.
/// Returns false for broken codes.
bool unpack_lzw(std::span<const std::byte> from, std::span<std::byte> to) {
    constexpr std::uint32_t Clear = 256, End = 257, Most = 4096;
    struct Entry {
        std::uint16_t before;
        std::uint16_t length;
        std::byte last, first;
    };
    std::vector<Entry> table(Most);
    for (std::uint32_t i = 0; i < Clear; ++i)
        table[i] = {0, 1, static_cast<std::byte>(i), static_cast<std::byte>(i)};
    std::uint32_t next = End + 1, width = 9, bits = 0, num_bits = 0;
    std::uint32_t previous = Clear;
    std::size_t at = 0, done = 0;
    while (done < to.size()) {
        while (num_bits < width) {
            if (at == from.size())
                return false;
            bits = bits << 8 | std::to_integer<std::uint32_t>(from[at++]);
            num_bits += 8;
        }
        const std::uint32_t code = bits >> (num_bits - width) & ((1U << width) - 1);
        num_bits -= width;
        if (code == End)
            return false;
        if (code == Clear) {
            next = End + 1;
            width = 9;
            previous = Clear;
            continue;
        }
        const bool is_new = code == next && previous != Clear;
        if ((code >= next && !is_new) || (previous == Clear && code > 255))
            return false;
        // A code that is not in the table yet is the string before with its first byte again.
        if (previous != Clear && next < Most) {
            table[next] = {static_cast<std::uint16_t>(previous),
                           static_cast<std::uint16_t>(table[previous].length + 1),
                           table[is_new ? previous : code].first, table[previous].first};
            ++next;
        }
        const std::size_t length = table[code].length;
        if (length > to.size() - done)
            return false;
        for (std::uint32_t i = 0, entry = code; i < length; ++i, entry = table[entry].before)
            to[done + length - 1 - i] = table[entry].last;
        done += length;
        previous = code;
        if (next + 1 >= (1U << width) && width < 12)
            ++width;
    }
    return true;
}

bool unpack_bits(std::span<const std::byte> from, std::span<std::byte> to) {
    std::size_t at = 0, done = 0;
    while (done < to.size()) {
        if (at == from.size())
            return false;
        const auto code = static_cast<std::int8_t>(from[at++]);
        if (code == -128)
            continue;
        const std::size_t count = static_cast<std::size_t>(code < 0 ? 1 - code : 1 + code);
        const std::size_t taken = code < 0 ? 1 : count;
        if (count > to.size() - done || taken > from.size() - at)
            return false;
        for (std::size_t i = 0; i < count; ++i)
            to[done++] = from[at + (code < 0 ? 0 : i)];
        at += taken;
    }
    return true;
}

bool unpack_deflate(std::span<const std::byte> from, std::span<std::byte> to) {
    libdeflate_decompressor* decompressor = libdeflate_alloc_decompressor();
    if (decompressor == nullptr)
        throw std::bad_alloc();
    std::size_t size = 0;
    const libdeflate_result result = libdeflate_zlib_decompress(
        decompressor, from.data(), from.size(), to.data(), to.size(), &size);
    libdeflate_free_decompressor(decompressor);
    return result == LIBDEFLATE_SUCCESS && size == to.size();
}

} // namespace

bool unpack(Packing packing, std::span<const std::byte> from, std::span<std::byte> to) {
    switch (packing) {
    case Packing::None:
        if (from.size() < to.size())
            return false;
        std::copy_n(from.begin(), to.size(), to.begin());
        return true;
    case Packing::Lzw:
        return unpack_lzw(from, to);
    case Packing::PackBits:
        return unpack_bits(from, to);
    case Packing::Zstd:
        return files::decompress(from, to);
    case Packing::Deflate:
    case Packing::OldDeflate:
        return unpack_deflate(from, to);
    }
    return false;
}

std::size_t most_ratio(Packing packing) {
    return packing == Packing::None   ? 1
           : packing == Packing::Zstd ? files::MaxCompressionRatio
                                      : 4000;
}

} // namespace relumine::cubemap::tiff
