#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stb/stb_image_write.h>

#include "cubemap/image/image_size.h"
#include "tests/cubemap/image/sample_files.h"
#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

/// A JPEG of one grey, which comes back as it is.
std::string grey_jpeg(int width, int height, std::uint8_t grey) {
    const std::vector<std::uint8_t> pixels(static_cast<std::size_t>(3 * width * height), grey);
    std::string file;
    stbi_write_jpg_to_func(
        [](void* to, void* data, int size) {
            static_cast<std::string*>(to)->append(static_cast<const char*>(data),
                                                  static_cast<std::size_t>(size));
        },
        &file, width, height, 3, pixels.data(), 95);
    return file;
}

std::string with_segment(std::string jpeg, int marker, const std::string& content) {
    const std::size_t size = content.size() + 2;
    std::string segment(4, '\xff');
    segment[1] = static_cast<char>(marker);
    segment[2] = static_cast<char>(size >> 8);
    segment[3] = static_cast<char>(size & 0xff);
    jpeg.insert(2, segment += content);
    return jpeg;
}

std::string with_xmp(const std::string& jpeg, const std::string& text) {
    std::string content("http://ns.adobe.com/xap/1.0/\0", 29);
    content += fmt::format("<rdf:Description hdrgm:Version=\"1.0\" {}</rdf:Description>", text);
    return with_segment(jpeg, 0xe1, content);
}

std::string with_iso(const std::string& jpeg, const std::string& numbers) {
    std::string content("urn:iso:std:iso:ts:21496:-1\0", 28);
    return with_segment(jpeg, 0xe2, content += numbers);
}

std::string big_endian(std::initializer_list<std::int32_t> values) {
    std::string text;
    for (const std::int32_t value : values)
        for (int shift = 24; shift >= 0; shift -= 8)
            text += static_cast<char>(value >> shift & 0xff);
    return text;
}

double light_of_srgb(double byte) {
    return std::pow((byte / 255.0 + 0.055) / 1.055, 2.4);
}

class GainMapFile : public testing::Test {
protected:
    static ImageFile decoded(const std::string& file) { return decode_text(file, "a.jpg"); }
    static std::string refusal(const std::string& file) {
        return message_of([&] { static_cast<void>(decoded(file)); });
    }
};

TEST_F(GainMapFile, AdobesNumbersBrightenThePicture) {
    const std::string map = grey_jpeg(16, 8, 128);
    const ImageFile image = decoded(
        grey_jpeg(16, 8, 200) + with_xmp(map, "hdrgm:GainMapMin=\"-1\" hdrgm:GainMapMax=\"5.5\" "
                                              "hdrgm:Gamma=\"0.5\" hdrgm:OffsetSDR=\"0.02\" "
                                              "hdrgm:OffsetHDR='0.01' "
                                              "hdrgm:HDRCapacityMax=\"5\">"));
    const double share = std::pow(128 / 255.0, 2.0);
    const double expected = (light_of_srgb(200) + 0.02) * std::exp2(-1 + 6.5 * share) - 0.01;
    ASSERT_EQ(image.pixels.size(), 128u);
    for (const glm::vec3& pixel : image.pixels)
        for (int channel = 0; channel < 3; ++channel)
            ASSERT_NEAR(pixel[channel], expected, 1e-5 * expected);
    EXPECT_THAT(image.remarks,
                testing::ElementsAre("gain map of Adobe's header (16x8), white is 1 and the most "
                                     "is 46.15, all of it shown from 5 stops above white on"));
}

TEST_F(GainMapFile, ListsAreForRedGreenAndBlue) {
    const ImageFile image =
        decoded(grey_jpeg(8, 8, 255) +
                with_xmp(grey_jpeg(8, 8, 255),
                         "><hdrgm:GainMapMax><rdf:Seq><rdf:li>1</rdf:li> <rdf:li>2"
                         "</rdf:li><rdf:li>3e0</rdf:li></rdf:Seq></hdrgm:GainMapMax>"));
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(image.pixels[0][channel], (1 + 1.0 / 64) * std::exp2(channel + 1) - 1.0 / 64,
                    1e-4);
}

TEST_F(GainMapFile, NumbersOfTheStandard) {
    const std::string base = with_iso(grey_jpeg(16, 8, 255), std::string(4, '\0'));
    const auto read = [&](char flags, const std::string& numbers) {
        std::string content(5, '\0');
        content[4] = flags;
        return decoded(base + with_iso(grey_jpeg(4, 2, 255), content += numbers));
    };
    // Headrooms, then of one channel: least, most, gamma and two offsets, fractions all.
    const ImageFile one = read(0x40, big_endian({0, 1, 4, 1, -1, 1, 7, 2, 1, 1, 1, 64, 1, 64}));
    const double expected = (1 + 1.0 / 64) * std::exp2(3.5) - 1.0 / 64;
    for (const glm::vec3& pixel : one.pixels)
        ASSERT_NEAR(pixel.y, expected, 1e-5 * expected);
    EXPECT_THAT(one.remarks[0], testing::StartsWith("gain map of ISO 21496-1 (4x2)"));
    // One denominator for all of three channels.
    const ImageFile three =
        read(static_cast<char>(0xc8),
             big_endian({64, 0, 256, 0, 64, 64, 1, 1, 0, 128, 64, 1, 1, 0, 192, 64, 1, 1}));
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(three.pixels[0][channel], (1 + 1.0 / 64) * std::exp2(channel + 1) - 1.0 / 64,
                    1e-4);
    EXPECT_NE(message_of([&] { static_cast<void>(read(0x40, big_endian({0, 1}))); }), "");
    EXPECT_NE(message_of([&] {
                  static_cast<void>(
                      read(0x40, big_endian({0, 0, 4, 0, -1, 0, 7, 0, 1, 0, 1, 0, 1, 0})));
              }),
              "")
        << "fractions of nothing";
}

/// By libultrahdr, of light of 1/4 on the left and 4 on the right.
TEST_F(GainMapFile, WhatLibultrahdrWrites) {
    const ImageFile image = decode_file(sample("gain_map/libultrahdr.jpg"));
    ASSERT_EQ(image.pixels.size(), 128u);
    for (int channel = 0; channel < 3; ++channel) {
        EXPECT_NEAR(image.pixels[2][channel], 0.25, 0.25 * 0.03);
        EXPECT_NEAR(image.pixels[13][channel], 4.0, 4.0 * 0.03);
    }
    EXPECT_EQ(read_image_size(sample("gain_map/libultrahdr.jpg")), (ImageSize{16, 8}));
    EXPECT_THAT(image.remarks, testing::Contains("P3-D65 converted to Rec. 709"));
}

TEST_F(GainMapFile, OthersAreRefused) {
    const std::string plain = grey_jpeg(8, 8, 9);
    EXPECT_EQ(refusal(plain),
              "a.jpg: expected a picture with light above white, got a JPEG without a gain map, "
              "which holds no light above white: use the .hdr or .exr that it was made from");
    EXPECT_EQ(refusal(with_xmp(plain, ">")),
              "a.jpg: expected a picture with light above white, got a JPEG whose gain map is "
              "missing");
    EXPECT_EQ(refusal(plain + with_xmp(plain, "hdrgm:GainMapMax=\"5\" "
                                              "hdrgm:BaseRenditionIsHDR=\"True\">")),
              "a.jpg: expected a gain map that makes a picture brighter, got one that makes it "
              "darker");
    EXPECT_THAT(refusal(plain + with_xmp(plain, "hdrgm:GainMapMax=\"500\">")),
                testing::StartsWith("a.jpg: expected a gain map of up to 32 stops, got 0 to 500"));
    const std::string good = plain + with_xmp(plain, "hdrgm:GainMapMax=\"5\">");
    EXPECT_EQ(refusal(good), "");
    EXPECT_THAT(refusal(good.substr(0, good.size() - 3)), testing::HasSubstr("broken data"));
    EXPECT_THAT(refusal("\xff\xd8\xff and more"), testing::HasSubstr("no light above white"));
}

} // namespace
} // namespace relumine::cubemap
