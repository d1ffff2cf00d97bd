#include "relight/pictures/picture.h"

#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

#include "cubemap/image/image_file.h"
#include "files/output_file.h"
#include "tests/own_folder.h"
#include "tests/prt/damaged_file.h"
#include "tests/prt/scenes.h"

namespace relumine::relight {
namespace {

namespace fs = std::filesystem;

class SavePictureTest : public tests::FolderTest {
protected:
    /// [height * width * 3] bytes of a PNG file.
    static std::vector<std::uint8_t> decoded(const fs::path& path, int& width, int& height) {
        int channels = 0;
        stbi_uc* bytes = stbi_load(path.c_str(), &width, &height, &channels, 0);
        if (bytes == nullptr) {
            ADD_FAILURE() << stbi_failure_reason();
            return {};
        }
        EXPECT_EQ(channels, 3);
        std::vector<std::uint8_t> result(bytes, bytes + std::ptrdiff_t{width} * height * 3);
        stbi_image_free(bytes);
        return result;
    }
};

TEST_F(SavePictureTest, PngHoldsTheSrgbCurve) {
    // Bytes from IEC 61966-2-1: 0.0031308 is where the line ends (12.92 x = 0.04045); 0.2140 is
    // half of the scale; 0.18 is 118.
    const Picture picture{.width = 4,
                          .height = 2,
                          .pixels = {{0.0f, 1.0f, 0.5f},
                                     {0.18f, 0.21404114f, 0.0031308f},
                                     {0.001f, 2.0f, 1e30f},
                                     {-1.0f, 0.0001f, 0.9f},
                                     {1.0f, 0.0f, 0.0f},
                                     {0.0f, 1.0f, 0.0f},
                                     {0.0f, 0.0f, 1.0f},
                                     {1.0f, 1.0f, 1.0f}}};
    const fs::path path = folder_ / "picture.png";
    save_picture(path, picture);
    int width = 0, height = 0;
    const std::vector<std::uint8_t> expected = {0,   255, 188, 118, 128, 10,  3,   255,
                                                255, 0,   0,   243, 255, 0,   0,   0,
                                                255, 0,   0,   0,   255, 255, 255, 255};
    EXPECT_EQ(decoded(path, width, height), expected);
    EXPECT_EQ(width, 4);
    EXPECT_EQ(height, 2);
}

TEST_F(SavePictureTest, ExposureDoublesPerStop) {
    const Picture picture{.width = 1, .height = 1, .pixels = {{0.1f, 0.2f, 0.4f}}};
    const auto bytes = [&](double ev) {
        save_picture(folder_ / "p.png", picture, {.exposure_ev = ev});
        int width = 0, height = 0;
        return decoded(folder_ / "p.png", width, height);
    };
    const auto zero = bytes(0.0), up = bytes(1.0), down = bytes(-1.0);
    EXPECT_EQ(up[0], zero[1]);
    EXPECT_EQ(up[1], zero[2]);
    EXPECT_EQ(down[1], zero[0]);
    EXPECT_EQ(down[2], zero[1]);
    const auto exr = [&](double ev) {
        save_picture(folder_ / "p.exr", picture, {.exposure_ev = ev, .tone = ToneCurve::Agx});
        return cubemap::decode_exr(files::read(folder_ / "p.exr"), "p.exr").pixels.at(0);
    };
    EXPECT_EQ(exr(0.0), picture.pixels[0]);
    EXPECT_EQ(exr(1.0), 2.0f * picture.pixels[0]);
    EXPECT_EQ(exr(-3.0), 0.125f * picture.pixels[0]);
}

TEST_F(SavePictureTest, PngGoesThroughTheToneCurveAtTheExposure) {
    const Picture picture{
        .width = 3, .height = 1, .pixels = {{0.1f, 0.2f, 0.4f}, {3.0f, 2.0f, 0.1f}, glm::vec3(9)}};
    for (const ToneCurve tone : {ToneCurve::Neutral, ToneCurve::Agx, ToneCurve::Aces}) {
        save_picture(folder_ / "p.png", picture, {.exposure_ev = 1.0, .tone = tone});
        Picture expected = picture;
        for (glm::vec3& pixel : expected.pixels)
            pixel = on_screen(tone, 2.0f * pixel);
        save_picture(folder_ / "expected.png", expected);
        EXPECT_EQ(files::read(folder_ / "p.png"), files::read(folder_ / "expected.png"));
    }
    // The curve is for the colour that covers a part of the pixel.
    const Picture half{.width = 1, .height = 1, .pixels = {{0.1f, 0.2f, 0.4f}}, .alpha = {0.5f}};
    save_picture(folder_ / "p.png", half, {.tone = ToneCurve::Neutral});
    save_picture(folder_ / "expected.png",
                 {.width = 1,
                  .height = 1,
                  .pixels = {0.5f * on_screen(ToneCurve::Neutral, {0.2f, 0.4f, 0.8f})},
                  .alpha = {0.5f}});
    EXPECT_EQ(files::read(folder_ / "p.png"), files::read(folder_ / "expected.png"));
}

TEST_F(SavePictureTest, ExrIsLinearFloatRowByRowFromTheTop) {
    Picture picture{.width = 3, .height = 2};
    for (int i = 0; i < 6; ++i)
        picture.pixels.emplace_back(i, 1e-3f * static_cast<float>(i), 1e6f * static_cast<float>(i));
    save_picture(folder_ / "p.exr", picture);
    const cubemap::ImageFile image = cubemap::decode_exr(files::read(folder_ / "p.exr"), "p.exr");
    EXPECT_EQ(image.width, 3u);
    EXPECT_EQ(image.height, 2u);
    EXPECT_EQ(image.pixels, picture.pixels);
    EXPECT_FALSE(image.envmap) << "a picture is no environment";
}

TEST_F(SavePictureTest, RefusesOtherNamesAndUnwritablePlaces) {
    const Picture picture{.width = 1, .height = 1, .pixels = {glm::vec3(1.0f)}};
    for (const char* name : {"p.jpg", "p", "p.hdr", "png"})
        EXPECT_THROW(save_picture(folder_ / name, picture), std::invalid_argument);
    const fs::path missing = folder_ / "missing" / "p.png";
    scenes::expect_refused(missing, "cannot write", [&] { save_picture(missing, picture); });
    EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(SavePictureTest, RefusesAPictureShortOfPixels) {
    const Picture picture{.width = 4, .height = 4, .pixels = {glm::vec3(1.0f)}};
    EXPECT_THROW(save_picture(folder_ / "p.png", picture), std::invalid_argument);
    EXPECT_THROW(save_picture(folder_ / "p.exr", picture), std::invalid_argument);
    EXPECT_TRUE(fs::is_empty(folder_));
}

} // namespace
} // namespace relumine::relight
