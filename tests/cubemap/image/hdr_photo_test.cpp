#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cubemap/image/color_space.h"
#include "cubemap/image/image_size.h"
#include "tests/cubemap/image/sample_files.h"
#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

using testing::HasSubstr;

#ifdef RELUMINE_HDR_PHOTOS

constexpr Primaries Rec2020{{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, {0.3127, 0.3290}};

/// What a display shows in the eight squares of each file, in cd/m2.
constexpr glm::dvec3 Pq[] = {{203, 203, 203}, {1000, 100, 10},    {10, 1000, 100},
                             {100, 10, 1000}, {4000, 4000, 4000}, {0, 0, 0},
                             {50, 60, 70},    {9000, 2000, 500}};
constexpr glm::dvec3 Hlg[] = {{203, 203, 203},    {800, 100, 10}, {10, 800, 100}, {100, 10, 450},
                              {1000, 1000, 1000}, {0, 0, 0},      {50, 60, 70},   {900, 500, 200}};

/// Compares the middles of the squares. `tolerance` is a share of a square's brightest colour.
void expect_squares(const std::string& file, std::span<const glm::dvec3> shown,
                    const glm::dmat3& to_ours, double tolerance) {
    SCOPED_TRACE(file);
    const ImageFile image = decode_file(sample(file));
    ASSERT_EQ(read_image_size(sample(file)), (ImageSize{16, 8}));
    ASSERT_EQ(image.pixels.size(), 16 * 8);
    for (std::size_t i = 0; i < 8; ++i) {
        const glm::dvec3 light = glm::max(to_ours * shown[i] / 203.0, glm::dvec3(0.0));
        const glm::dvec3 found = image.pixels[(4 * (i / 4) + 1) * 16 + 4 * (i % 4) + 1];
        const double most = std::max({light.x, light.y, light.z, 1e-3});
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(found[channel], light[channel], tolerance * most)
                << "square " << i << ", channel " << channel;
    }
}

TEST(HdrPhotos, LightIsThatOfADisplayWhoseWhiteIsOne) {
    const glm::dmat3 wide = to_rec709(Rec2020);
    // Half a step of 10, 12 and 16 bits, and what packing with a loss adds.
    expect_squares("avif/avifenc_pq.avif", Pq, wide, 0.004);
    expect_squares("avif/ffmpeg_pq.avif", Pq, wide, 0.01);
    expect_squares("avif/avifenc_hlg.avif", Hlg, wide, 0.02);
    expect_squares("jxl/cjxl_pq.jxl", Pq, wide, 0.001);
    expect_squares("jxl/cjxl_hlg.jxl", Hlg, wide, 0.001);
}

TEST(HdrPhotos, FloatsOfJpegXlAreLight) {
    expect_squares("jxl/cjxl_linear.jxl", Pq, glm::dmat3(1.0), 1e-6);
    expect_squares("jxl/imagecodecs_half.jxl", Pq, glm::dmat3(1.0), 1e-3);
}

/// cjxl marks a PFM so, whatever its numbers are.
TEST(HdrPhotos, FloatsByACurveBecomeLight) {
    const ImageFile image = decode_file(sample("jxl/cjxl_curved.jxl"));
    EXPECT_NEAR(image.pixels[1 * 16 + 5].x, linear(1000.0f / 203.0f, Transfer::Srgb), 1e-3f);
    EXPECT_THAT(image.remarks, testing::Contains(HasSubstr("Rec. 709 by sRGB's curve converted")));
}

TEST(HdrPhotos, BrokenOnesAreRefused) {
    for (const char* file : {"avif/avifenc_pq.avif", "jxl/cjxl_pq.jxl"}) {
        const std::vector<std::byte> whole = files::read(sample(file));
        const ImageFormat& format = format_of(whole, file);
        for (std::size_t size = 64; size < whole.size(); size += 16)
            EXPECT_THAT(message_of([&] {
                            static_cast<void>(format.decode(std::span(whole).first(size), "a"));
                        }),
                        HasSubstr("a: expected a whole "));
    }
}

#else

TEST(HdrPhotos, ABuildWithoutThemSaysSo) {
    for (const char* file : {"avif/avifenc_pq.avif", "jxl/cjxl_pq.jxl"})
        EXPECT_THAT(message_of([&] { static_cast<void>(decode_file(sample(file))); }),
                    HasSubstr("got AVIF or JPEG XL, which this build does not read "
                              "(packages/hdr-photos.txt, -DRELUMINE_HDR_PHOTOS=ON)"));
}

#endif

} // namespace
} // namespace relumine::cubemap
