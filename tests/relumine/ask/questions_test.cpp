#include "relumine/ask/questions.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/prt/scenes.h"
#include "tests/relumine/small_scenes.h"

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

prt::Surface shiny(float roughness) {
    return {.albedo = glm::vec3(0.3f),
            .specular = glm::vec3(0.5f),
            .highlight = prt::Highlight::GgxWhole,
            .roughness_or_exponent = roughness};
}

TEST(Verify, OfAnEyeCountsTheFrontsThatItSees) {
    const glm::vec3 eye(2.0f, 3.0f, 4.0f);
    LitScene lit(precompute(
        Mesh(scenes::icosphere(3, 0.5f, glm::vec3(0.0f))),
        {.tolerance = scenes::Tolerance, .no_refine = true, .surface = everywhere(shiny(0.4f))}));
    lit.light(cubemap::CubeMap(16, glm::vec3(1.0f)));
    const Verification check = verify(lit, {.num_samples = 0, .eye = eye});
    const prt::Receivers& receivers = lit.scene().receivers;
    EXPECT_LT(check.receivers.size(), receivers.size());
    for (const std::uint32_t i : check.receivers)
        EXPECT_GT(glm::dot(receivers.normals[i], eye - receivers.positions[i]), 0.0f);
    EXPECT_LT(check.error.relative_l2, 0.03);
    EXPECT_THROW(static_cast<void>(verify(lit, {.num_samples = 0, .eye = glm::vec3(0.0f)})),
                 std::invalid_argument);
}

// The sun's shadows are as sharp in a picture of a glossy mesh as in one of a matt mesh.
TEST(Verify, OfAPictureTracesLightsOfGlossyMeshesToo) {
    const auto error = [](const std::optional<prt::Surface>& surface) {
        PrecomputeOptions options{.tolerance = scenes::Tolerance, .no_refine = true};
        if (surface) {
            options.surface = everywhere(*surface);
            options.view = View{.camera = Camera{.eye = {1, 1, 4}, .target = {0, 0, 0}}};
        }
        LitScene lit(precompute(Mesh(scenes::boulder()), options));
        lit.light(scenes::sun_and_sky());
        EXPECT_EQ(lit.scene().transfer.glossy.has_value(), surface.has_value());
        return verify(lit, {.num_samples = 1, .num_surface_points = 200})
            .picture->error.relative_l2;
    };
    EXPECT_NEAR(error(shiny(0.4f)), error({}), 1e-4);
}

} // namespace
} // namespace relumine
