#include "cubemap/resample/kept_shares.h"

#include <gtest/gtest.h>

#include "cubemap/image/environment.h"
#include "cubemap/resample/pixel_shares.h"
#include "cubemap/resample/resample.h"
#include "tests/cubemap/test_images.h"

namespace relumine::cubemap::detail {
namespace {

/// Odd sizes have pixels and texels on the mirrors.
TEST(KeptShares, AveragesBitByBitAsTheirPlainVersions) {
    for (const Layout layout : {Layout::AngularMap, Layout::MirrorBall, Layout::Octahedral}) {
        for (const std::uint32_t width : {15u, 24u}) {
            for (const std::uint32_t resolution : {7u, 16u}) {
                EnvironmentImage image = black_image(layout, Sampling::TexelCentres, width);
                fill_randomly(image.pixels, 3);
                const KeptShares kept(shape_of(image), resolution);
                const CubeMap map = resample(image, resolution);
                EXPECT_EQ(kept.to_cube(image.pixels).texels, map.texels) << name(layout) << width;
                EXPECT_EQ(kept.to_pixels(map), to_image(map, layout, width, width).pixels)
                    << name(layout) << width;
            }
        }
    }
}

TEST(KeptShares, FindLatLongsOfEitherSampling) {
    for (const Sampling sampling : {Sampling::TexelCentres, Sampling::Borders}) {
        EnvironmentImage image = black_image(Layout::LatLong, sampling, 24);
        fill_randomly(image.pixels, 4);
        const CubeMap map = resample(image, 9);
        EXPECT_EQ(KeptShares(shape_of(image), 9).to_pixels(map),
                  to_image(map, Layout::LatLong, image.width, image.height, sampling).pixels);
    }
}

} // namespace
} // namespace relumine::cubemap::detail
