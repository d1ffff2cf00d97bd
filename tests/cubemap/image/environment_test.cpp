#include "cubemap/image/environment.h"
#include "cubemap/resample/save_environment.h"

#include <ctime>
#include <limits>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "cubemap/image/image_file.h"
#include "cubemap/image/image_layout.h"
#include "cubemap/resample/resample.h"
#include "files/output_file.h"
#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

void write(const std::filesystem::path& path, const std::vector<std::byte>& bytes) {
    files::OutputFile file(path);
    file.write(bytes);
    file.commit();
}

EnvironmentImage grey(Layout layout, Sampling sampling, std::uint32_t width, std::uint32_t height) {
    EnvironmentImage image = black_image(layout, sampling, width, height);
    image.pixels.assign(image.pixels.size(), glm::vec3(0.5f));
    return image;
}

TEST(Environment, LayoutsAreToldByTheirProportions) {
    const TemporaryFolder folder;
    const auto layout_of = [&](std::uint32_t width, std::uint32_t height) {
        write(folder / "a.hdr",
              encode_hdr(grey(Layout::LatLong, Sampling::TexelCentres, width, height)));
        const EnvironmentImage image = load_environment(folder / "a.hdr");
        EXPECT_EQ(image.sampling, Sampling::TexelCentres);
        return std::pair{image.layout, image.assumptions};
    };
    EXPECT_EQ(
        layout_of(20, 10),
        std::pair(Layout::LatLong,
                  std::string("2:1 image without envmap attribute, samples at texel centres")));
    EXPECT_EQ(layout_of(5, 30).first, Layout::Cube);
    EXPECT_EQ(layout_of(12, 16).first, Layout::VerticalCross);
    EXPECT_EQ(message_of([&] { (void)layout_of(10, 10); }),
              (folder / "a.hdr").string() +
                  ": expected --layout angular, mirrorball or octahedral for a "
                  "square picture (or a 2:1 lat-long, a 1:6 or 6:1 "
                  "cube, a 3:4 or 4:3 cross), got 10x10");
}

TEST(Environment, TheAttributeDecidesLayoutAndSampling) {
    const TemporaryFolder folder;
    write(folder / "a.exr", encode_exr(grey(Layout::LatLong, Sampling::Borders, 21, 10)));
    const EnvironmentImage image = load_environment(folder / "a.exr");
    EXPECT_EQ(image.layout, Layout::LatLong);
    EXPECT_EQ(image.sampling, Sampling::Borders);
    EXPECT_EQ(image.assumptions, "lat-long as the envmap attribute says, samples on the borders");

    write(folder / "b.exr", encode_exr(grey(Layout::Cube, Sampling::Borders, 20, 10)));
    EXPECT_EQ(message_of([&] { (void)load_environment(folder / "b.exr"); }),
              (folder / "b.exr").string() + ": expected a 1:6 image for layout cube, got 20x10");
}

TEST(Environment, TheCallerMayKnowBetter) {
    const TemporaryFolder folder;
    write(folder / "a.exr", encode_exr(grey(Layout::LatLong, Sampling::Borders, 4, 24)));
    EXPECT_EQ(load_environment(folder / "a.exr").layout, Layout::LatLong);
    const EnvironmentImage cube = load_environment(folder / "a.exr", {.layout = Layout::Cube});
    EXPECT_EQ(cube.layout, Layout::Cube);
    EXPECT_EQ(cube.sampling, Sampling::TexelCentres);
    EXPECT_THROW((void)load_environment(folder / "a.exr", {.layout = Layout::VerticalCross}),
                 std::runtime_error);
}

class BadPixelsTest : public testing::Test {
protected:
    void SetUp() override {
        EnvironmentImage image = grey(Layout::LatLong, Sampling::TexelCentres, 8, 4);
        image.pixels[11] = {-1.0f, 2.0f, 3.0f};
        image.pixels[12].y = std::numeric_limits<float>::infinity();
        image.pixels[13] = {std::numeric_limits<float>::quiet_NaN(), -1.0f, 7.0f};
        image.pixels[14].x = -std::numeric_limits<float>::infinity();
        write(path_, encode_exr(image));
    }
    TemporaryFolder folder_;
    std::filesystem::path path_ = folder_ / "bad.exr";
};

TEST_F(BadPixelsTest, AreRefusedWithCountAndPosition) {
    EXPECT_EQ(message_of([&] { (void)load_environment(path_); }),
              path_.string() + ": expected finite radiance >= 0, got 3 NaN/Inf and 1 negative "
                               "pixels (4.8 % of the light), first at (3, 1); use --fix-env");
}

TEST_F(BadPixelsTest, AreFixedWhenAskedFor) {
    const EnvironmentImage image = load_environment(path_, {.fix_bad_pixels = true});
    EXPECT_TRUE(image.fixed);
    EXPECT_EQ(image.bad_pixels.num_nan, 1u);
    EXPECT_EQ(image.bad_pixels.num_infinite, 2u);
    EXPECT_EQ(image.bad_pixels.num_negative, 1u);
    EXPECT_EQ(image.pixels[11], glm::vec3(0.0f, 2.0f, 3.0f));
    EXPECT_EQ(image.pixels[12], glm::vec3(0.5f, 7.0f, 0.5f));
    EXPECT_EQ(image.pixels[13], glm::vec3(0.0f, 0.0f, 7.0f));
    EXPECT_EQ(image.pixels[14], glm::vec3(0.0f, 0.5f, 0.5f));
}

TEST_F(BadPixelsTest, WhatNoLightCanBeIsInfinite) {
    EnvironmentImage image;
    image.width = 4;
    image.height = 2;
    image.pixels.assign(8, glm::vec3(0.5f));
    image.pixels[2] = glm::vec3(3e38f, 1.0f, 1.0f);
    save_image(path_, image);
    EXPECT_EQ(message_of([&] { (void)load_environment(path_); }),
              path_.string() + ": expected finite radiance >= 0, got 1 NaN/Inf and 0 negative "
                               "pixels, first at (2, 0); use --fix-env");
    EXPECT_EQ(load_environment(path_, {.fix_bad_pixels = true}).pixels[2],
              glm::vec3(1.0f, 1.0f, 1.0f));
}

TEST_F(BadPixelsTest, AreLoadedAsTheyAreForInspection) {
    const EnvironmentImage image = load_environment(path_, {.refuse_bad_pixels = false});
    EXPECT_FALSE(image.fixed);
    EXPECT_EQ(image.bad_pixels.count(), 4u);
    EXPECT_EQ(image.bad_pixels.first_x, 3u);
    EXPECT_EQ(image.bad_pixels.first_y, 1u);
    EXPECT_EQ(image.pixels[11].x, -1.0f);
}

TEST(Environment, HugeFiniteValuesAreNotBad) {
    const TemporaryFolder folder;
    EnvironmentImage image = grey(Layout::LatLong, Sampling::TexelCentres, 8, 4);
    image.pixels[5] = glm::vec3(BadPixels::MostRadiance);
    write(folder / "a.exr", encode_exr(image));
    EXPECT_EQ(load_environment(folder / "a.exr").bad_pixels.count(), 0u);
}

TEST(Environment, APixelWithMuchOfTheLightAsksForAFinerMap) {
    const auto resolution = [](std::uint32_t width, float sun, Layout layout = Layout::LatLong) {
        const std::uint32_t height = layout == Layout::LatLong ? width / 2 : width;
        EnvironmentImage image;
        image.width = width;
        image.height = height;
        image.layout = layout;
        image.pixels.assign(std::size_t{width} * height, glm::vec3(1.0f));
        // The sum over a lat-long of height h is about 4 h^2 / pi.
        image.pixels[std::size_t{height / 2} * width + 3] = glm::vec3(
            sun * static_cast<float>(height) * static_cast<float>(height) * 4.0f / 3.1415927f);
        return automatic_resolution(image);
    };
    EXPECT_EQ(resolution(8, 0.5f), 8u);
    EXPECT_EQ(resolution(64, 0.5f), 64u);
    EXPECT_EQ(resolution(256, 0.009f), 64u);
    EXPECT_EQ(resolution(256, 0.011f), 256u);
    EXPECT_EQ(resolution(1024, 0.009f), 256u);
    EXPECT_EQ(resolution(1024, 0.011f), 512u);
    EXPECT_EQ(resolution(2048, 0.011f), 1024u);
    EXPECT_EQ(resolution(8192, 0.5f), 2048u);
    EXPECT_EQ(resolution(512, 0.5f, Layout::AngularMap), 256u);
}

TEST(Environment, SavedFilesReadBackToTheSamePowerAndPicture) {
    const TemporaryFolder folder;
    CubeMap map(32);
    for (const Face face : AllFaces) {
        for (std::uint32_t y = 0; y < 32; ++y) {
            for (std::uint32_t x = 0; x < 32; ++x)
                map.at(face, x, y) = glm::vec3(texel_direction(face, x, y, 32) * 0.4 + 0.5);
        }
    }
    map.at(Face::PositiveX, 3, 4) = glm::vec3(1e4f);
    for (const std::string extension : {".exr", ".hdr", ".EXR"}) {
        for (const Layout layout : {Layout::Cube, Layout::LatLong, Layout::VerticalCross}) {
            const std::filesystem::path path = folder / ("a" + extension);
            save_environment(path, map, layout);
            const EnvironmentImage image = load_environment(path);
            EXPECT_EQ(image.layout, layout);
            EXPECT_EQ(natural_resolution(image), 32u);
            const bool with_attribute = extension != ".hdr" && layout != Layout::VerticalCross;
            EXPECT_EQ(image.sampling, with_attribute ? Sampling::Borders : Sampling::TexelCentres);
            const CubeMap back = resample(image, 32);
            // RGBE has 8 bits, and the sun is most of this power.
            EXPECT_NEAR(total_power(back).x / total_power(map).x, 1.0,
                        extension == ".hdr" ? 3e-3 : 1e-5);
            // Away from the sun the picture is smooth, so it must come back.
            for (const Face face : {Face::NegativeX, Face::PositiveY, Face::NegativeY,
                                    Face::PositiveZ, Face::NegativeZ}) {
                for (std::uint32_t y = 2; y < 30; ++y) {
                    for (std::uint32_t x = 2; x < 30; ++x)
                        ASSERT_LT(glm::distance(back.at(face, x, y), map.at(face, x, y)), 0.03f)
                            << extension;
                }
            }
            std::filesystem::remove(path);
            EXPECT_EQ(folder.num_files(), 0u) << "nothing else is left behind";
        }
    }
}

TEST(Environment, ACrossWithoutAttributeComesBackExactly) {
    const TemporaryFolder folder;
    CubeMap map(8);
    fill_randomly(map.texels, 1);
    save_environment(folder / "a.exr", map, Layout::VerticalCross);
    EXPECT_EQ(resample(load_environment(folder / "a.exr"), 8).texels, map.texels);
}

TEST(Environment, UnwritablePathsAreNamedAndNothingIsLeft) {
    const TemporaryFolder folder;
    const CubeMap map(4, glm::vec3(-1.0f));
    EXPECT_EQ(message_of([&] { save_environment(folder / "a.png", map); }),
              (folder / "a.png").string() +
                  ": expected a name that ends in .exr or .hdr, got '.png'");
    EXPECT_NE(message_of([&] {
                  save_environment(folder / "none/a.exr", map);
              }).find("none/a.exr: cannot write"),
              std::string::npos);
    EXPECT_NE(message_of([&] {
                  save_environment(folder / "a.hdr", map);
              }).find("a.hdr: expected radiance from 0"),
              std::string::npos);
    EXPECT_EQ(folder.num_files(), 0u);
}

TEST(Environment, FilesThatAreNoneAreRefused) {
    const TemporaryFolder folder;
    EXPECT_EQ(message_of([&] { (void)load_environment(folder / "none.exr"); }),
              (folder / "none.exr").string() + ": cannot read: No such file or directory");
    write(folder / "empty.exr", {});
    EXPECT_THAT(message_of([&] { (void)load_environment(folder / "empty.exr"); }),
                testing::AllOf(testing::StartsWith((folder / "empty.exr").string() +
                                                   ": expected an OpenEXR, Radiance .hdr, TIFF"),
                               testing::EndsWith(" file, got an empty file")));
    write(folder / "text.hdr", std::vector<std::byte>(100, std::byte{'x'}));
    EXPECT_NE(message_of([&] { (void)load_environment(folder / "text.hdr"); }), "");
}

TEST(Environment, TheFormatIsToldByTheContent) {
    const TemporaryFolder folder;
    write(folder / "really_hdr.exr",
          encode_hdr(grey(Layout::LatLong, Sampling::TexelCentres, 20, 10)));
    EXPECT_EQ(load_environment(folder / "really_hdr.exr").width, 20u);
}

TEST(EnvironmentData, DamagedFilesAreRefusedAtOnceInOneLine) {
    for (const std::string file : {"damaged_0.exr", "damaged_1.exr", "oiio_bomb-40000.hdr",
                                   "BrightRingsNanInf.exr", "AllHalfValues.exr"}) {
        const auto path = data_file("robustness/" + file);
        if (path.empty())
            GTEST_SKIP() << absent_data("envs");
        const auto start = std::clock();
        const std::string message = message_of([&] { (void)load_environment(path); });
        EXPECT_TRUE(message.starts_with(path.string() + ": expected ")) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos);
        EXPECT_LT(std::clock() - start, 10 * CLOCKS_PER_SEC);
    }
    // As what they are, they load.
    const LoadOptions anyway{.layout = Layout::LatLong, .refuse_bad_pixels = false};
    EXPECT_EQ(
        load_environment(data_file("robustness/BrightRingsNanInf.exr"), anyway).bad_pixels.count(),
        12u);
    const BadPixels bad =
        load_environment(data_file("robustness/AllHalfValues.exr"), anyway).bad_pixels;
    EXPECT_EQ(bad.num_nan + bad.num_infinite, 2048u);
    EXPECT_EQ(bad.num_negative, 31743u) << "all negative halfs but -0, NaN and infinity";
}

TEST(Environment, NegativePixelsWithHardlyAnyLightBecomeZero) {
    const TemporaryFolder folder;
    // 128 pixels of 0.5 and 0.25: 96 in all. The rows beside the equator have 2 % of the sphere per
    // pixel.
    EnvironmentImage image = grey(Layout::LatLong, Sampling::TexelCentres, 16, 8);
    const auto share = [&](float value) {
        image.pixels[16 * 3 + 5] = {value, 0.5f, 0.5f};
        write(folder / "a.exr", encode_exr(image));
        return load_environment(folder / "a.exr", {.refuse_bad_pixels = false})
            .bad_pixels.negative_share;
    };
    double all = 0.0, pixel = 0.0;
    for_each_pixel({image.layout, image.sampling, 16, 8},
                   [&](std::size_t index, const PixelPlace& place) {
                       all += place.solid_angle;
                       if (index == 16 * 3 + 5)
                           pixel = place.solid_angle;
                   });
    EXPECT_NEAR(share(-0.25f), 0.25 * pixel / (1.5 * all - 0.5 * pixel), 1e-9);
    const EnvironmentImage clamped = load_environment(folder / "a.exr");
    EXPECT_TRUE(clamped.fixed);
    EXPECT_EQ(clamped.bad_pixels.num_negative, 1u);
    EXPECT_EQ(clamped.pixels[16 * 3 + 5], glm::vec3(0.0f, 0.5f, 0.5f));
    // More than 1 % is no filter's rest.
    EXPECT_GT(share(-2.0f), 0.01);
    EXPECT_NE(message_of([&] {
                  (void)load_environment(folder / "a.exr");
              }).find("got 0 NaN/Inf and 1 negative pixels (1."),
              std::string::npos);
    EXPECT_EQ(load_environment(folder / "a.exr", {.fix_bad_pixels = true}).pixels[16 * 3 + 5].x,
              0.0f);
    // One NaN among them is enough to refuse the file.
    image.pixels[3].y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_LT(share(-0.01f), 0.01);
    EXPECT_NE(message_of([&] {
                  (void)load_environment(folder / "a.exr");
              }).find("got 1 NaN/Inf and 1 negative pixels"),
              std::string::npos);
}

TEST(EnvironmentData, FilesOfBlenderLoadWithTheirNegativePixels) {
    for (const auto& [file, num_negative] :
         {std::pair{"blender_studio_1k.exr", 3u}, std::pair{"blender_interior_1k.exr", 5053u},
          std::pair{"blender_sunset_1k.exr", 5u}}) {
        const auto path = data_file(std::string("latlong/") + file);
        if (path.empty())
            GTEST_SKIP() << absent_data("envs");
        const EnvironmentImage image = load_environment(path);
        EXPECT_TRUE(image.fixed);
        EXPECT_EQ(image.bad_pixels.num_negative, num_negative);
        EXPECT_LT(image.bad_pixels.negative_share, 1e-3);
    }
}

} // namespace
} // namespace relumine::cubemap
