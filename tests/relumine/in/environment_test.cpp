#include "relumine/in/environment.h"

#include <limits>

#include "cubemap/resample/resample.h"
#include "cubemap/resample/save_environment.h"
#include "data_gen/environments.h"
#include "tests/relumine/small_scenes.h"

namespace relumine {
namespace {

class EnvironmentFile : public scenes::InFolder {};

TEST_F(EnvironmentFile, IsResampledAndTurned) {
    const cubemap::CubeMap sky = data_gen::two_soft_boxes(16);
    cubemap::save_environment(file("sky.exr"), sky, cubemap::Layout::LatLong);
    const cubemap::EnvironmentImage image = cubemap::load_environment(file("sky.exr"));

    const Environment own = load_environment(file("sky.exr"));
    EXPECT_EQ(own.map.texels,
              cubemap::resample(image, cubemap::automatic_resolution(image)).texels);
    EXPECT_EQ(own.assumptions, image.assumptions);
    EXPECT_EQ(own.num_fixed_pixels, 0u);

    const Environment turned =
        load_environment(file("sky.exr"), {.face_resolution = 8, .rotate_degrees = 90.0});
    EXPECT_EQ(turned.map.resolution, 8u);
    EXPECT_EQ(turned.map.texels, cubemap::rotated(cubemap::resample(image, 8), 90.0).texels);
}

TEST_F(EnvironmentFile, WithBadPixelsIsFixedOnlyWhenAsked) {
    cubemap::EnvironmentImage image =
        cubemap::to_image(cubemap::CubeMap(4, glm::vec3(1.0f)), cubemap::Layout::LatLong, 16, 8);
    image.pixels[20].g = std::numeric_limits<float>::quiet_NaN();
    cubemap::save_image(file("bad.exr"), image);
    EXPECT_THROW(static_cast<void>(load_environment(file("bad.exr"))), std::runtime_error);
    EXPECT_EQ(load_environment(file("bad.exr"), {.fix_bad_pixels = true}).num_fixed_pixels, 1u);

    image.pixels[20].g = std::numeric_limits<float>::infinity();
    cubemap::save_image(file("bad.exr"), image);
    EXPECT_THAT(load_environment(file("bad.exr"), {.fix_bad_pixels = true}).warnings,
                testing::ElementsAre("1 infinite pixels became 1, the largest radiance of the "
                                     "others: the light there was brighter"));
}

} // namespace
} // namespace relumine
