// Based on: Khronos Data Format Specification 1.3, "BC6H"; Microsoft, "BC6H Format".
#include "cubemap/image/bc6h.h"

#include <cstdint>
#include <string_view>
#include <vector>

#include <half.h>

namespace relumine::cubemap {

namespace {

/// Ends of the first line of colours are w and x, those of the second are y and z.
enum End : std::uint8_t { W, X, Y, Z };

/// Where a bit of a block belongs.
struct Bit {
    /// 0 to 2; 3: the number of the partition
    std::uint8_t channel;
    End end;
    std::uint8_t bit;
};

struct Mode {
    unsigned mark;
    /// How many bits w has, and what x, y and z differ from it by
    int num_bits;
    std::array<int, 3> num_delta_bits;
    bool has_two_lines;
    /// x, y and z are no differences
    bool is_plain;
    /// Behind the mark: channel, end and bit or bits in their order; d is the partition
    std::string_view bits;
};

constexpr std::array<Mode, 14> Modes = {{
    {0,
     10,
     {5, 5, 5},
     true,
     false,
     "gy4 by4 bz4 rw0-9 gw0-9 bw0-9 rx0-4 gz4 gy0-3 gx0-4 bz0 gz0-3 bx0-4 bz1 by0-3 ry0-4 bz2 "
     "rz0-4 bz3 dw0-4"},
    {1,
     7,
     {6, 6, 6},
     true,
     false,
     "gy5 gz4 gz5 rw0-6 bz0 bz1 by4 gw0-6 by5 bz2 gy4 bw0-6 bz3 bz5 bz4 rx0-5 gy0-3 gx0-5 gz0-3 "
     "bx0-5 by0-3 ry0-5 rz0-5 dw0-4"},
    {2,
     11,
     {5, 4, 4},
     true,
     false,
     "rw0-9 gw0-9 bw0-9 rx0-4 rw10 gy0-3 gx0-3 gw10 bz0 gz0-3 bx0-3 bw10 bz1 by0-3 ry0-4 bz2 "
     "rz0-4 bz3 dw0-4"},
    {6,
     11,
     {4, 5, 4},
     true,
     false,
     "rw0-9 gw0-9 bw0-9 rx0-3 rw10 gz4 gy0-3 gx0-4 gw10 gz0-3 bx0-3 bw10 bz1 by0-3 ry0-3 bz0 bz2 "
     "rz0-3 gy4 bz3 dw0-4"},
    {10,
     11,
     {4, 4, 5},
     true,
     false,
     "rw0-9 gw0-9 bw0-9 rx0-3 rw10 by4 gy0-3 gx0-3 gw10 bz0 gz0-3 bx0-4 bw10 by0-3 ry0-3 bz1 bz2 "
     "rz0-3 bz4 bz3 dw0-4"},
    {14,
     9,
     {5, 5, 5},
     true,
     false,
     "rw0-8 by4 gw0-8 gy4 bw0-8 bz4 rx0-4 gz4 gy0-3 gx0-4 bz0 gz0-3 bx0-4 bz1 by0-3 ry0-4 bz2 "
     "rz0-4 bz3 dw0-4"},
    {18,
     8,
     {6, 5, 5},
     true,
     false,
     "rw0-7 gz4 by4 gw0-7 bz2 gy4 bw0-7 bz3 bz4 rx0-5 gy0-3 gx0-4 bz0 gz0-3 bx0-4 bz1 by0-3 ry0-5 "
     "rz0-5 dw0-4"},
    {22,
     8,
     {5, 6, 5},
     true,
     false,
     "rw0-7 bz0 by4 gw0-7 gy5 gy4 bw0-7 gz5 bz4 rx0-4 gz4 gy0-3 gx0-5 gz0-3 bx0-4 bz1 by0-3 ry0-4 "
     "bz2 rz0-4 bz3 dw0-4"},
    {26,
     8,
     {5, 5, 6},
     true,
     false,
     "rw0-7 bz1 by4 gw0-7 by5 gy4 bw0-7 bz5 bz4 rx0-4 gz4 gy0-3 gx0-4 bz0 gz0-3 bx0-5 by0-3 ry0-4 "
     "bz2 rz0-4 bz3 dw0-4"},
    {30,
     6,
     {6, 6, 6},
     true,
     true,
     "rw0-5 gz4 bz0 bz1 by4 gw0-5 gy5 by5 bz2 gy4 bw0-5 gz5 bz3 bz5 bz4 rx0-5 gy0-3 gx0-5 gz0-3 "
     "bx0-5 by0-3 ry0-5 rz0-5 dw0-4"},
    {3, 10, {10, 10, 10}, false, true, "rw0-9 gw0-9 bw0-9 rx0-9 gx0-9 bx0-9"},
    {7, 11, {9, 9, 9}, false, false, "rw0-9 gw0-9 bw0-9 rx0-8 rw10 gx0-8 gw10 bx0-8 bw10"},
    {11,
     12,
     {8, 8, 8},
     false,
     false,
     "rw0-9 gw0-9 bw0-9 rx0-7 rw11-10 gx0-7 gw11-10 bx0-7 bw11-10"},
    {15,
     16,
     {4, 4, 4},
     false,
     false,
     "rw0-9 gw0-9 bw0-9 rx0-3 rw15-10 gx0-3 gw15-10 bx0-3 bw15-10"},
}};

std::vector<Bit> bits_of(std::string_view text) {
    std::vector<Bit> bits;
    const auto number = [&](std::size_t& at) {
        unsigned value = 0;
        for (; at < text.size() && text[at] >= '0' && text[at] <= '9'; ++at)
            value = value * 10 + static_cast<unsigned>(text[at] - '0');
        return value;
    };
    for (std::size_t at = 0; at < text.size(); ++at) {
        const auto channel = static_cast<std::uint8_t>(std::string_view("rgbd").find(text[at]));
        const auto end = static_cast<End>(std::string_view("wxyz").find(text[at + 1]));
        at += 2;
        const unsigned first = number(at);
        unsigned last = first;
        if (at < text.size() && text[at] == '-')
            last = number(++at);
        for (unsigned bit = first;; bit += last > first ? 1U : -1U) {
            bits.push_back({channel, end, static_cast<std::uint8_t>(bit)});
            if (bit == last)
                break;
        }
    }
    return bits;
}

const std::array<std::vector<Bit>, Modes.size()>& bits_of_modes() {
    static const auto All = [] {
        std::array<std::vector<Bit>, Modes.size()> all;
        for (std::size_t i = 0; i < all.size(); ++i)
            all[i] = bits_of(Modes[i].bits);
        return all;
    }();
    return All;
}

/// Which pixels are on the second line: bit 4 y + x.
constexpr std::array<std::uint16_t, 32> Partitions = {
    0xcccc, 0x8888, 0xeeee, 0xecc8, 0xc880, 0xfeec, 0xfec8, 0xec80, 0xc800, 0xffec, 0xfe80,
    0xe800, 0xffe8, 0xff00, 0xfff0, 0xf000, 0xf710, 0x008e, 0x7100, 0x08ce, 0x008c, 0x7310,
    0x3100, 0x8cce, 0x088c, 0x3110, 0x6666, 0x366c, 0x17e8, 0x0ff0, 0x718e, 0x399c};
/// The pixel of the second line whose index lacks its highest bit, which is 0.
constexpr std::array<std::uint8_t, 32> Anchors = {15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15,
                                                  15, 15, 15, 15, 15, 15, 2,  8,  2,  2,  8,
                                                  8,  15, 2,  8,  2,  2,  8,  8,  2,  2};

constexpr std::array<int, 8> Weights3 = {0, 9, 18, 27, 37, 46, 55, 64};
constexpr std::array<int, 16> Weights4 = {0,  4,  9,  13, 17, 21, 26, 30,
                                          34, 38, 43, 47, 51, 55, 60, 64};

int sign_extended(int value, int num_bits) {
    const int sign = 1 << (num_bits - 1);
    return (value & (sign - 1)) - (value & sign);
}

/// Spreads a number of few bits over 16.
int unquantized(int value, int num_bits, bool is_signed) {
    if (!is_signed) {
        if (num_bits >= 15 || value == 0)
            return value;
        return value == (1 << num_bits) - 1 ? 0xffff : ((value << 16) + 0x8000) >> num_bits;
    }
    if (num_bits >= 16 || value == 0)
        return value;
    const int size = value < 0 ? -value : value;
    const int spread =
        size >= (1 << (num_bits - 1)) - 1 ? 0x7fff : ((size << 15) + 0x4000) >> (num_bits - 1);
    return value < 0 ? -spread : spread;
}

/// Returns the number that has the bits of a half float.
float value_of(int bits, bool is_signed) {
    if (!is_signed)
        return imath_half_to_float(static_cast<std::uint16_t>((bits * 31) >> 6));
    const int size = ((bits < 0 ? -bits : bits) * 31) >> 5;
    return imath_half_to_float(static_cast<std::uint16_t>(bits < 0 ? size | 0x8000 : size));
}

} // namespace

std::array<glm::vec3, 16> decode_bc6h(std::span<const std::byte, 16> block, bool is_signed) {
    const auto bits_at = [&](std::size_t at, int count) {
        unsigned value = 0;
        for (int i = 0; i < count; ++i, ++at)
            value |= (std::to_integer<unsigned>(block[at / 8]) >> at % 8 & 1U) << i;
        return value;
    };
    std::array<glm::vec3, 16> pixels{};
    const unsigned low = bits_at(0, 2);
    const std::size_t mark_bits = low < 2 ? 2 : 5;
    const unsigned mark = low < 2 ? low : bits_at(0, 5);
    std::size_t index = 0;
    while (index < Modes.size() && Modes[index].mark != mark)
        ++index;
    if (index == Modes.size())
        return pixels;
    const Mode& mode = Modes[index];

    std::array<std::array<int, 4>, 4> ends{};
    std::size_t at = mark_bits;
    for (const Bit& bit : bits_of_modes()[index])
        ends[bit.channel][bit.end] |= static_cast<int>(bits_at(at++, 1)) << bit.bit;
    const auto partition = static_cast<std::size_t>(ends[3][W]);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        std::array<int, 4>& values = ends[channel];
        if (is_signed)
            values[W] = sign_extended(values[W], mode.num_bits);
        for (const End end : {X, Y, Z}) {
            if (!mode.is_plain)
                values[end] =
                    (values[W] + sign_extended(values[end], mode.num_delta_bits[channel])) &
                    ((1 << mode.num_bits) - 1);
            if (is_signed)
                values[end] = sign_extended(values[end], mode.num_bits);
        }
        for (int& value : values)
            value = unquantized(value, mode.num_bits, is_signed);
    }
    const int index_bits = mode.has_two_lines ? 3 : 4;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const bool is_second = mode.has_two_lines && (Partitions[partition] >> i & 1) != 0;
        const bool is_anchor = i == 0 || (mode.has_two_lines && i == Anchors[partition]);
        const unsigned place = bits_at(at, index_bits - (is_anchor ? 1 : 0));
        at += static_cast<std::size_t>(index_bits - (is_anchor ? 1 : 0));
        const int weight = mode.has_two_lines ? Weights3[place] : Weights4[place];
        for (int channel = 0; channel < 3; ++channel) {
            const std::array<int, 4>& values = ends[static_cast<std::size_t>(channel)];
            const int from = values[is_second ? Y : W], to = values[is_second ? Z : X];
            pixels[i][channel] =
                value_of((from * (64 - weight) + to * weight + 32) >> 6, is_signed);
        }
    }
    return pixels;
}

} // namespace relumine::cubemap
