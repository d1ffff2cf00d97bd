// Words of bits, one bit per receiver or direction, and the transpose of a square of bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace relumine::prt {

/// Receivers come in words of 64, one bit each.
inline constexpr std::size_t WordSize = 64;

/// Transposes 64 x 64 bits in place: bit j of word i becomes bit i of word j. Swaps off-diagonal
/// quarters of 32 x 32 bits, then of 16 x 16 in each half, and so on (Warren, Hacker's Delight,
/// 7-3).
inline void transpose(std::span<std::uint64_t, 64> rows) {
    std::uint64_t mask = 0x00000000ffffffff;
    for (std::size_t width = 32; width != 0; width >>= 1u, mask ^= mask << width)
        for (std::size_t begin = 0; begin < 64; begin += 2 * width)
            for (std::size_t i = begin; i < begin + width; ++i) { // neighbours, for vectors
                const std::uint64_t swapped = (rows[i] >> width ^ rows[i + width]) & mask;
                rows[i] ^= swapped << width;
                rows[i + width] ^= swapped;
            }
}

} // namespace relumine::prt
