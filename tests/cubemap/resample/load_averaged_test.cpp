#include "cubemap/resample/load_averaged.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "cubemap/resample/resample.h"
#include "cubemap/resample/resize_lat_long.h"
#include "files/output_file.h"
#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

EnvironmentImage noise(std::uint32_t width, Sampling sampling) {
    EnvironmentImage image = black_image(Layout::LatLong, sampling, width, width / 2);
    fill_randomly(image.pixels, width);
    return image;
}

/// Means of the file as it is when it is read whole.
std::vector<glm::vec3> means(const EnvironmentImage& whole, std::uint32_t width,
                             std::uint32_t height) {
    std::vector<glm::vec3> result;
    LatLongResize(shape_of(whole), {.width = width, .height = height}, glm::dmat3(1.0))
        .average(whole.pixels, result);
    return result;
}

void expect_near(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
    ASSERT_EQ(a.size(), b.size());
    double largest = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        largest = std::max(largest, glm::length(glm::dvec3(a[i]) - glm::dvec3(b[i])) /
                                        (1.0 + glm::length(glm::dvec3(b[i]))));
    EXPECT_LT(largest, 1e-6);
}

TEST(LoadAveraged, BandsAreTheMeansOfThePictureThatIsReadWhole) {
    const TemporaryFolder folder;
    for (const char* name : {"a.exr", "a.hdr"})
        for (const Sampling sampling : {Sampling::TexelCentres, Sampling::Borders})
            // Two columns become one, three, and a share.
            for (const std::uint32_t most : {600U, 400U, 290U}) {
                SCOPED_TRACE(std::string(name) + " " + std::to_string(most));
                const auto path = folder / name;
                save_image(path, noise(1200, sampling));
                const EnvironmentImage whole = load_environment(path);
                const EnvironmentImage read = load_averaged(path, {}, most);
                EXPECT_LE(read.width, most);
                EXPECT_EQ(read.width, 2 * read.height);
                EXPECT_EQ(read.sampling, Sampling::TexelCentres);
                EXPECT_EQ(read.num_file_pixels, 1200U * 600U);
                expect_near(read.pixels, means(whole, read.width, read.height));
                const glm::dvec3 power = total_power(whole);
                EXPECT_LT(glm::length(total_power(read) - power), 1e-6 * glm::length(power));
                EXPECT_NE(read.assumptions.find("1200x600 pixels averaged to "), std::string::npos)
                    << read.assumptions;
            }
}

TEST(LoadAveraged, ASunKeepsItsLightAndItsPlace) {
    const TemporaryFolder folder;
    EnvironmentImage sky = black_image(Layout::LatLong, Sampling::TexelCentres, 1024, 512);
    sky.pixels[std::size_t{101} * 1024 + 333] = glm::vec3(50'000.0f, 40'000.0f, 30'000.0f);
    save_image(folder / "sun.exr", sky);
    const CubeMap whole = resample(load_environment(folder / "sun.exr"), 32);
    const CubeMap read = resample(load_averaged(folder / "sun.exr", {}, 512), 32);
    expect_near(read.texels, whole.texels);
}

TEST(LoadAveraged, SmallMapsAndOtherLayoutsAreReadWhole) {
    const TemporaryFolder folder;
    const EnvironmentImage small = noise(256, Sampling::TexelCentres);
    save_image(folder / "small.hdr", small);
    EXPECT_EQ(load_averaged(folder / "small.hdr", {}, 256), load_environment(folder / "small.hdr"));
    EnvironmentImage cube = black_image(Layout::HorizontalStrip, Sampling::TexelCentres, 64);
    fill_randomly(cube.pixels, 1);
    save_image(folder / "cube.exr", cube);
    EXPECT_EQ(load_averaged(folder / "cube.exr", {}, 64), load_environment(folder / "cube.exr"));
}

/// A test's .hdr of flat pixels: the same bytes for each.
void write_hdr(const std::filesystem::path& path, const std::string& header, std::size_t width,
               std::size_t height) {
    std::ofstream file(path, std::ios::binary);
    file << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n" << header;
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x)
            file << static_cast<char>(y / 2 + 10) << static_cast<char>(x / 2 + 10)
                 << static_cast<char>(7) << static_cast<char>(129);
}

TEST(LoadAveraged, WhatAnHdrHeaderSaysHolds) {
    const TemporaryFolder folder;
    const auto path = folder / "a.hdr";
    for (const std::string header :
         {"\n-Y 64 +X 128\n", "\n+Y 64 -X 128\n", "EXPOSURE=4\n\n-Y 64 +X 128\n",
          "PRIMARIES=0.713 0.293 0.165 0.830 0.128 0.044 0.32168 0.33767\n\n-Y 64 +X 128\n"}) {
        SCOPED_TRACE(header);
        write_hdr(path, header, 128, 64);
        const EnvironmentImage whole = load_environment(path);
        const EnvironmentImage read = load_averaged(path, {}, 64);
        expect_near(read.pixels, means(whole, 64, 32));
        EXPECT_EQ(read.assumptions, whole.assumptions + ", 128x64 pixels averaged to 64x32");
    }
    write_hdr(path, "\n-Y 64 +X 128\n", 128, 63);
    EXPECT_EQ(message_of([&] { static_cast<void>(load_averaged(path, {}, 64)); }),
              message_of([&] { static_cast<void>(load_environment(path)); }));
}

TEST(LoadAveraged, BadPixelsAreJudgedInTheFilesOwnSize) {
    const TemporaryFolder folder;
    const auto path = folder / "bad.exr";
    EnvironmentImage image = noise(1024, Sampling::TexelCentres);
    image.pixels[std::size_t{300} * 1024 + 7].y = -1e-4f;
    save_image(path, image);
    EnvironmentImage read = load_averaged(path, {}, 512);
    const EnvironmentImage harmless = load_environment(path);
    EXPECT_TRUE(read.fixed);
    EXPECT_EQ(read.bad_pixels.num_negative, 1U);
    EXPECT_NEAR(read.bad_pixels.negative_share, harmless.bad_pixels.negative_share, 1e-12);
    expect_near(read.pixels, means(harmless, 512, 256));

    image.pixels[std::size_t{256} * 1024 + 9].x = std::numeric_limits<float>::infinity();
    image.pixels[std::size_t{40} * 1024 + 10].z = std::numeric_limits<float>::quiet_NaN();
    save_image(path, image);
    const auto refusal = [&](const auto& load) {
        return message_of([&] { load(); });
    };
    const std::string message = refusal([&] { static_cast<void>(load_averaged(path, {}, 512)); });
    EXPECT_EQ(message, refusal([&] { static_cast<void>(load_environment(path)); }));
    EXPECT_NE(message.find("first at (10, 40)"), std::string::npos) << message;
    const LoadOptions fix{.fix_bad_pixels = true};
    read = load_averaged(path, fix, 512);
    const EnvironmentImage whole = load_environment(path, fix);
    EXPECT_EQ(read.infinity_became, whole.infinity_became);
    EXPECT_EQ(read.bad_pixels.count(), whole.bad_pixels.count());
    expect_near(read.pixels, means(whole, 512, 256));
}

TEST(LoadAveraged, TransparentPixelsAreCounted) {
    const TemporaryFolder folder;
    EnvironmentImage image = noise(1024, Sampling::TexelCentres);
    image.alpha.assign(image.pixels.size(), 1.0f);
    for (std::size_t i = 0; i < 5000; ++i)
        image.alpha[7 * i] = 0.0f;
    save_image(folder / "a.exr", image);
    EXPECT_EQ(load_averaged(folder / "a.exr", {}, 400).num_transparent, 5000U);
}

} // namespace
} // namespace relumine::cubemap
