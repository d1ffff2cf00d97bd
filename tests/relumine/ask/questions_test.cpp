#include "relumine/ask/questions.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/prt/scenes.h"

namespace relumine {
namespace {

/// A ball of radius 1 around the origin.
const LitScene& ball() {
    static const LitScene lit(unclustered_scene(scenes::icosphere(5, 1.0f, glm::vec3(0.0f))));
    return lit;
}

constexpr glm::vec3 Eye(0.0f, 0.0f, 4.0f);

TEST(LightDirection, FacesThePointThatIsSeenOrIsMirroredThereForTheEye) {
    for (const glm::vec3 aimed : {glm::vec3(0, 0, 1), {0.5f, 0.3f, 0.8f}, {-0.6f, 0.1f, 0.6f}}) {
        const glm::vec3 normal = glm::normalize(aimed), to_eye = glm::normalize(Eye - normal);
        const auto facing = light_direction(ball(), Eye, normal - Eye, Aim::Facing);
        ASSERT_TRUE(facing);
        EXPECT_LT(glm::length(*facing - normal), 0.01f);
        const auto mirrored = light_direction(ball(), Eye, normal - Eye, Aim::Mirrored);
        ASSERT_TRUE(mirrored);
        // The normal halves the angle between the light and the eye.
        EXPECT_LT(glm::length(glm::normalize(*mirrored + to_eye) - normal), 0.01f);
        EXPECT_NEAR(glm::length(*mirrored), 1.0f, 1e-5f);
    }
}

TEST(LightDirection, IsOnTheSideThatIsSeenAndNoneBesideTheMesh) {
    const auto inside = light_direction(ball(), glm::vec3(0.0f), {0, 0, -1}, Aim::Facing);
    ASSERT_TRUE(inside);
    EXPECT_GT(inside->z, 0.99f);
    EXPECT_FALSE(light_direction(ball(), Eye, {0, 1, 0}, Aim::Mirrored));
}

} // namespace
} // namespace relumine
