#include "relight/pictures/region_picture.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/lights/test_maps.h"

namespace relumine::relight {
namespace {

using namespace lights; // NOLINT

const glm::vec3& at(const Picture& picture, std::uint32_t x, std::uint32_t y) {
    return picture.pixels[y * picture.width + x];
}

TEST(RegionPicture, ShowsMapBordersAndLights) {
    const auto image = lat_long(64, 32, [](std::uint32_t x, std::uint32_t) {
        return x < 32 ? glm::vec3(4.0f, 0.5f, 0.5f) : glm::vec3(0.5f, 0.5f, 10.8f); // as bright
    });
    const Placement placement = place(Method::MedianCut, image, 2);
    ASSERT_EQ(placement.regions[0].x1, 32u);
    const Picture picture = region_picture(image, placement);
    ASSERT_EQ(picture.width, 1024u);
    ASSERT_EQ(picture.height, 512u);
    ASSERT_EQ(picture.pixels.size(), 1024u * 512u);
    // The border at column 32, that is 512 in the picture; the halves' own colours beside it.
    EXPECT_GT(at(picture, 512, 100).g, 2.0f * at(picture, 512, 100).r);
    EXPECT_GT(at(picture, 400, 100).r, 3.0f * at(picture, 400, 100).b);
    EXPECT_GT(at(picture, 600, 100).b, 3.0f * at(picture, 600, 100).r);
    // The first light is at +X, a quarter from the left at half height: light in the middle, a dark
    // ring around it.
    EXPECT_GT(at(picture, 256, 256).r, 0.9f);
    EXPECT_GT(at(picture, 256, 256).g, 0.3f);
    bool ring = false;
    for (std::uint32_t x = 257; x < 266; ++x)
        ring = ring || at(picture, x, 256) == glm::vec3(0.0f);
    EXPECT_TRUE(ring);
}

TEST(RegionPicture, ColoursAreInRangeWhateverTheMap) {
    for (const auto& image :
         {wild(300, 150), constant(1, 1, glm::vec3(0.0f)), constant(5000, 3, glm::vec3(1e30f)),
          constant(2, 1, glm::vec3(1e-30f))}) {
        for (const Method method : AllMethods) {
            const Picture picture = region_picture(image, place(method, image, 1));
            EXPECT_LE(picture.width, 2048u);
            EXPECT_GE(picture.width, 1024u);
            EXPECT_TRUE(std::all_of(
                picture.pixels.begin(), picture.pixels.end(), [](const glm::vec3& pixel) {
                    return pixel.r >= 0.0f && pixel.r <= 1.0f && pixel.g >= 0.0f &&
                           pixel.g <= 1.0f && pixel.b >= 0.0f && pixel.b <= 1.0f;
                }));
        }
    }
}

} // namespace
} // namespace relumine::relight
