// Words of bits, one bit per receiver or direction, and the transpose of a square of bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace relumine::prt {

/// Receivers come in words of 64, one bit each.
inline constexpr std::size_t WordSize = 64;

namespace detail {

/// Swaps the off-diagonal quarters of each square of 2 Width x 2 Width bits. With a constant width
/// the compiler works on several words at once.
template<std::size_t Width>
void swap_quarters(std::span<std::uint64_t, WordSize> rows, std::uint64_t mask) {
    for (std::size_t begin = 0; begin < WordSize; begin += 2 * Width)
        for (std::size_t i = begin; i < begin + Width; ++i) {
            const std::uint64_t swapped = (rows[i] >> Width ^ rows[i + Width]) & mask;
            rows[i] ^= swapped << Width;
            rows[i + Width] ^= swapped;
        }
}

} // namespace detail

/// Transposes 64 x 64 bits in place: bit j of word i becomes bit i of word j (Warren, Hacker's
/// Delight, 7-3).
inline void transpose(std::span<std::uint64_t, WordSize> rows) {
    detail::swap_quarters<32>(rows, 0x00000000ffffffff);
    detail::swap_quarters<16>(rows, 0x0000ffff0000ffff);
    detail::swap_quarters<8>(rows, 0x00ff00ff00ff00ff);
    detail::swap_quarters<4>(rows, 0x0f0f0f0f0f0f0f0f);
    detail::swap_quarters<2>(rows, 0x3333333333333333);
    detail::swap_quarters<1>(rows, 0x5555555555555555);
}

} // namespace relumine::prt
