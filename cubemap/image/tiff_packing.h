// How TIFF packs strips and tiles. Based on: Adobe, TIFF Revision 6.0, 1992.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace relumine::cubemap::tiff {

/// By the numbers of the field Compression
enum class Packing : std::uint16_t {
    None = 1,
    Lzw = 5,
    Deflate = 8,
    OldDeflate = 32946,
    PackBits = 32773,
    Zstd = 50000
};

/// Unpacks what fills `to`. Returns false for broken bytes, and for a packing that is unknown.
[[nodiscard]] bool unpack(Packing packing, std::span<const std::byte> from,
                          std::span<std::byte> to);

/// Returns how many times smaller the bytes can be than what is unpacked from them.
[[nodiscard]] std::size_t most_ratio(Packing packing);

} // namespace relumine::cubemap::tiff
