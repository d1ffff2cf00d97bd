#include "relumine/out/first_sight.h"

#include <gtest/gtest.h>

#include "relumine/in/precompute.h"
#include "relumine/out/output.h"
#include "tests/prt/scenes.h"
#include "tests/relight/environments.h"
#include "tests/relumine/small_scenes.h"

namespace relumine {
namespace {

TEST(FirstSight, ABallInAFurnaceIsAsBright) {
    LitScene lit(quick_scene(scenes::icosphere(3, 1.0f, glm::vec3(0.0f))));
    EXPECT_EQ(lit.radiance().size(), 0u);
    lit.light(cubemap::CubeMap(16, glm::vec3(2.0f)));
    for (const glm::vec3& radiance : lit.radiance())
        EXPECT_NEAR(radiance.g, 2.0f, 0.06f);
}

TEST(FirstSight, IsNearThePictureThatFollows) {
    const Mesh mesh = scenes::boulder();
    // The whole picture, drawn with as few rays: what differs is the light.
    const OutputOptions options = quick_picture({.width = 160, .height = 120});
    const auto drawn = [&](Scene scene) {
        LitScene lit(std::move(scene));
        lit.light(scenes::sun_and_sky());
        return draw(lit, options).pixels;
    };
    const std::vector<glm::vec3> first = drawn(quick_scene(mesh)), whole = drawn(precompute(mesh));
    ASSERT_EQ(first.size(), whole.size());
    double difference = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < first.size(); ++i) {
        difference += double{std::abs(first[i].g - whole[i].g)};
        sum += double{whole[i].g};
    }
    EXPECT_LT(difference, 0.05 * sum);
    EXPECT_GT(difference, 0.0);
}

TEST(FirstSight, HasTheShapeOfThePicture) {
    const OutputOptions wide = quick_picture({.width = 4000, .height = 1000});
    EXPECT_EQ(wide.width, 400u);
    EXPECT_EQ(wide.height, 100u);
    EXPECT_EQ(wide.samples_per_axis, 1u);
    const OutputOptions small = quick_picture({.width = 7, .height = 300, .highlight_rays = 0});
    EXPECT_EQ(small.width, 7u);
    EXPECT_EQ(small.height, 300u);
    EXPECT_EQ(small.highlight_rays, 0u);
    EXPECT_EQ(quick_picture({.width = 1, .height = 10000}).width, 1u);
}

} // namespace
} // namespace relumine
