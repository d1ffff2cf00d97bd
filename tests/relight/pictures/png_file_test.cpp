#include "relight/pictures/png_file.h"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "files/parallel.h"

namespace relumine::relight {
namespace {

std::uint32_t number_at(const std::vector<std::byte>& bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
        value = value << 8 | std::to_integer<std::uint32_t>(bytes.at(at + i));
    return value;
}

TEST(PngFile, ThreadsDoNotMatterAndTheHeaderIsRight) {
    constexpr std::uint32_t Width = 301, Height = 200;
    std::vector<std::uint8_t> pixels(std::size_t{Width} * Height * 4);
    for (std::size_t i = 0; i < pixels.size(); ++i)
        pixels[i] = static_cast<std::uint8_t>(i * i / 977 + i);
    const std::vector<std::byte> png = encode_png(Width, Height, 4, pixels);
    EXPECT_EQ(number_at(png, 0), 0x89504e47u);
    EXPECT_EQ(number_at(png, 16), Width);
    EXPECT_EQ(number_at(png, 20), Height);
    EXPECT_EQ(number_at(png, png.size() - 8), 0x49454e44u); // IEND
    const files::ThreadLimit one(1);
    EXPECT_EQ(encode_png(Width, Height, 4, pixels), png);
}

} // namespace
} // namespace relumine::relight
