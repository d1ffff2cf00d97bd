#include "cubemap/image/bc6h.h"

#include <array>
#include <cstddef>

#include <gtest/gtest.h>

namespace relumine::cubemap {
namespace {

using Block = std::array<std::byte, 16>;

void set(Block& block, std::size_t first, unsigned value, int num_bits) {
    for (int i = 0; i < num_bits; ++i, ++first)
        block[first / 8] |= static_cast<std::byte>((value >> i & 1) << first % 8);
}

/// Mode 11 has two ends of 10 bits and an index of 4 bits for each pixel.
TEST(Bc6h, TwoEndsAndSixteenSteps) {
    Block block{};
    set(block, 0, 3, 5);
    set(block, 5, 0, 10);     // red from 0
    set(block, 15, 480, 10);  // green
    set(block, 25, 1023, 10); // blue
    set(block, 35, 1023, 10); // red to the most
    set(block, 45, 480, 10);
    set(block, 55, 0, 10);
    set(block, 65 + 3, 15, 4); // the second pixel, behind the first with its 3 bits
    const auto pixels = decode_bc6h(block, false);
    // 480 of 10 bits becomes 30752 of 16, and 30752 * 31 / 64 = 0x3a2f are the bits of a half.
    EXPECT_EQ(pixels[0].x, 0.0f);
    EXPECT_EQ(pixels[0].y, 0.5f * (1.0f + 0x22f / 1024.0f));
    EXPECT_EQ(pixels[0].z, 65504.0f) << "the most that halves hold";
    EXPECT_EQ(pixels[1].x, 65504.0f);
    EXPECT_EQ(pixels[1].z, 0.0f);
}

TEST(Bc6h, SignedEndsMayBeNegative) {
    Block block{};
    set(block, 0, 3, 5);
    set(block, 5, 0x201, 10); // -511, the least
    const auto pixels = decode_bc6h(block, true);
    EXPECT_EQ(pixels[0].x, -65504.0f);
    EXPECT_EQ(pixels[0].y, 0.0f);
}

TEST(Bc6h, ReservedModesAreBlack) {
    for (const unsigned mark : {0x13u, 0x17u, 0x1bu, 0x1fu}) {
        Block block;
        block.fill(std::byte{0xff});
        block[0] = static_cast<std::byte>(0xe0 | mark);
        EXPECT_EQ(decode_bc6h(block, false)[5], glm::vec3(0.0f));
    }
}

} // namespace
} // namespace relumine::cubemap
