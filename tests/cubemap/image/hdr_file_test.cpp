#include "cubemap/image/image_file.h"

#include <cmath>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

std::vector<std::byte> bytes_of(const std::string& text) {
    std::vector<std::byte> bytes(text.size());
    std::memcpy(bytes.data(), text.data(), text.size());
    return bytes;
}

std::string pixel(int r, int g, int b, int e) {
    return {static_cast<char>(r), static_cast<char>(g), static_cast<char>(b), static_cast<char>(e)};
}

ImageFile decode(const std::string& text) {
    return decode_hdr(bytes_of(text), "name");
}

std::string refusal(const std::string& text) {
    return message_of([&] { (void)decode(text); });
}

const std::string Header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";

TEST(HdrFile, FlatPixelsHaveTheirValues) {
    const ImageFile image =
        decode(Header + "-Y 1 +X 2\n" + pixel(128, 64, 255, 129) + pixel(1, 2, 3, 0));
    EXPECT_EQ(image.pixels,
              (std::vector<glm::vec3>{{1.0f, 0.5f, 255.0f / 128.0f}, {0.0f, 0.0f, 0.0f}}));
}

TEST(HdrFile, OldRunsRepeatThePixelBefore) {
    const ImageFile image = decode(Header + "-Y 1 +X 300\n" + pixel(128, 0, 0, 129) +
                                   pixel(1, 1, 1, 42) + pixel(1, 1, 1, 1) + pixel(0, 128, 0, 129));
    ASSERT_EQ(image.pixels.size(), 300u);
    EXPECT_EQ(image.pixels[298], glm::vec3(1.0f, 0.0f, 0.0f));
    EXPECT_EQ(image.pixels[299], glm::vec3(0.0f, 1.0f, 0.0f));
}

TEST(HdrFile, ExposureAndColorCorrectionAreDividedOut) {
    const ImageFile image =
        decode("#?RGBE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\nSOFTWARE=x\nEXPOSURE= 4.0\n"
               "COLORCORR= 1 0.5 2\n\n-Y 1 +X 1\n" +
               pixel(128, 128, 128, 132));
    EXPECT_EQ(image.pixels[0], glm::vec3(1.0f, 2.0f, 0.5f));
    EXPECT_EQ(image.remarks.size(), 1u);
}

TEST(HdrFile, PrimariesAreConverted) {
    const auto of = [](const std::string& primaries) {
        return decode("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nPRIMARIES=" + primaries +
                      "\n\n-Y 1 +X 1\n" + pixel(128, 128, 128, 129));
    };
    const ImageFile wide = of(" 0.708 0.292 0.170 0.797 0.131 0.046 0.3127 0.3290");
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(wide.pixels[0][channel], 1.0f, 1e-5f) << "white stays white";
    EXPECT_THAT(wide.remarks, testing::ElementsAre("Rec. 2020 converted to Rec. 709"));
    EXPECT_TRUE(of("0.64 0.33 0.30 0.60 0.15 0.06 0.3127 0.3290").remarks.empty());
    EXPECT_TRUE(of("0 0 0 0 0 0 0 0").remarks.empty()) << "as FreeImage writes where none are set";
    EXPECT_THAT(of("0.1 0.1 0.2 0.2 0.3 0.3 0.3 0.3").remarks,
                testing::ElementsAre(testing::HasSubstr("passed over")));
    EXPECT_THROW(static_cast<void>(of("0.64 0.33")), std::runtime_error);
}

/// FreeImage writes EXPOSURE=0 where nothing was set.
TEST(HdrFile, AnExposureOfZeroIsNone) {
    const ImageFile image = decode("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=0\n\n-Y 1 +X 1\n" +
                                   pixel(128, 64, 0, 129));
    EXPECT_EQ(image.pixels[0], glm::vec3(1.0f, 0.5f, 0.0f));
    EXPECT_THAT(image.remarks, testing::ElementsAre("EXPOSURE=0 of the header counts as 1"));
}

TEST(HdrFile, RowsAndColumnsMayRunTheOtherWay) {
    const std::string pixels =
        pixel(128, 0, 0, 129) + pixel(0, 128, 0, 129) + pixel(0, 0, 128, 129) + pixel(0, 0, 0, 0);
    const auto upright = decode(Header + "-Y 2 +X 2\n" + pixels).pixels;
    const auto flipped = decode(Header + "+Y 2 -X 2\n" + pixels).pixels;
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_EQ(flipped[i], upright[3 - i]);
}

TEST(HdrFile, OtherContentIsRefusedByName) {
    EXPECT_EQ(refusal("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd"),
              "name: expected FORMAT=32-bit_rle_rgbe, got FORMAT=32-bit_rle_xyze");
    EXPECT_EQ(refusal(Header + "+X 2 -Y 1\nabcdabcd"),
              "name: expected rows of pixels (-Y H +X W), got '+X 2 -Y 1'");
    EXPECT_EQ(refusal(Header + "-Y 40000 +X 40000\nabcd"),
              "name: expected a size that an environment can have, got 40000x40000");
    EXPECT_EQ(refusal(Header + "-Y 4000 +X 8000\nabcd"),
              "name: expected data for 8000x4000 pixels, got 4 bytes");
    EXPECT_EQ(refusal(Header + "-Y 0 +X 8\nabcd"),
              "name: expected a size that an environment can have, got 8x0");
    EXPECT_EQ(refusal(Header + "hello\nabcd"),
              "name: expected a resolution line such as -Y 512 +X 1024, got 'hello'");
    EXPECT_EQ(refusal(Header + "-Y 2 +X 1\nabcd"),
              "name: expected 2 rows, got a file that ends in row 1");
    EXPECT_EQ(refusal("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=-1\n\n-Y 1 +X 1\nabcd"),
              "name: expected a positive exposure, got -1");
    EXPECT_NE(refusal("#?RADIANCE\nEXPOSURE=nan\n\n-Y 1 +X 1\nabcd"), "");
    EXPECT_NE(refusal("#?RADIANCE\nEXPOSURE=0x10\n\n-Y 1 +X 1\nabcd"), "");
    EXPECT_NE(refusal("#?RADIANCE\nEXPOSURE=x\n\n-Y 1 +X 1\nabcd"), "");
    EXPECT_NE(refusal(Header + "-Y 1 +X 2\n" + pixel(1, 1, 1, 1) + "abcd"), "")
        << "a repetition of nothing";
    EXPECT_NE(refusal(Header + "-Y 1 +X 8\n" + std::string("\2\2\0\10\0\0\0\0\0\0\0\0\0", 13)), "")
        << "a run of no pixels";
}

EnvironmentImage random_image(std::uint32_t width, std::uint32_t height) {
    EnvironmentImage image = black_image(Layout::LatLong, Sampling::TexelCentres, width, height);
    std::mt19937 generator(width);
    std::uniform_real_distribution<float> exponent(-6.0f, 5.0f);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        // Stretches of equal pixels, so that there are runs to encode.
        image.pixels[i] = i % 50 > 15 && i > 0 ? image.pixels[i - 1]
                                               : glm::vec3(std::pow(10.0f, exponent(generator)));
        image.pixels[i].y *= 0.5f;
    }
    return image;
}

TEST(HdrFile, RoundTripIsRoundedToNearest) {
    for (const std::uint32_t width : {1u, 7u, 8u, 127u, 128u, 129u, 500u}) {
        const EnvironmentImage image = random_image(width, 20);
        const ImageFile back = decode_hdr(encode_hdr(image), "name");
        ASSERT_EQ(back.width, width);
        ASSERT_EQ(back.height, 20u);
        double sum = 0.0, sum_back = 0.0;
        for (std::size_t i = 0; i < image.pixels.size(); ++i) {
            const float largest = image.pixels[i].x;
            ASSERT_NEAR(back.pixels[i].x, largest, largest / 255.0f);
            ASSERT_NEAR(back.pixels[i].y, image.pixels[i].y, largest / 255.0f);
            sum += std::log(largest);
            sum_back += std::log(back.pixels[i].x);
        }
        EXPECT_NEAR((sum_back - sum) / static_cast<double>(image.pixels.size()), 0.0, 2e-3)
            << "no bias";
    }
}

TEST(HdrFile, ValuesNextToAPowerOfTwoDoNotOverflow) {
    EnvironmentImage image = black_image(Layout::LatLong, Sampling::TexelCentres, 4, 1);
    image.pixels = {glm::vec3(0.999f), glm::vec3(0.99999f), glm::vec3(1.0f), glm::vec3(1.5e38f)};
    const auto back = decode_hdr(encode_hdr(image), "name").pixels;
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_NEAR(back[i].x / image.pixels[i].x, 1.0f, 1.0f / 255.0f);
}

TEST(HdrFile, RefusesToWriteWhatItCannotHold) {
    EnvironmentImage image = black_image(Layout::LatLong, Sampling::TexelCentres, 2, 1);
    for (const float bad : {-1.0f, std::nanf(""), 3e38f, HUGE_VALF}) {
        image.pixels[1].z = bad;
        EXPECT_THROW((void)encode_hdr(image), std::invalid_argument);
    }
}

TEST(HdrFile, TruncationsAreRefusedAndCorruptionsDoNoHarm) {
    const std::vector<std::byte> good = encode_hdr(random_image(40, 20));
    for (std::size_t length = 0; length < good.size(); ++length)
        ASSERT_NE(message_of([&] { (void)decode_hdr(std::span(good).first(length), "name"); }), "")
            << length;
    for (std::size_t i = 0; i < good.size(); ++i) {
        for (const int flip : {0x01, 0x80, 0xff}) {
            std::vector<std::byte> bad = good;
            bad[i] ^= static_cast<std::byte>(flip);
            const std::string message = message_of([&] { (void)decode_hdr(bad, "name"); });
            ASSERT_TRUE(message.empty() || message.starts_with("name: expected ")) << message;
        }
    }
}

} // namespace
} // namespace relumine::cubemap
