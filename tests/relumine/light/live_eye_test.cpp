// Highlights of a lit scene for an eye that moves.
#include "relumine/light/live_eye.h"

#include <memory>
#include <stdexcept>
#include <vector>

#include <glm/vec3.hpp>
#include <gtest/gtest.h>

#include "mesh/floor.h"
#include "relumine/in/precompute.h"
#include "relumine/in/scene.h"
#include "tests/relight/environments.h"
#include "tests/relumine/small_scenes.h"

namespace relumine {
namespace {

prt::Surface shiny(float roughness) {
    return {.albedo = glm::vec3(0.3f),
            .specular = glm::vec3(0.4f),
            .highlight = prt::Highlight::GgxWhole,
            .roughness_or_exponent = roughness};
}

Scene shiny_scene(float roughness) {
    Mesh mesh = scenes::boulder();
    mesh::append_floor(mesh.geometry, 4);
    mesh.floor_vertices = 4;
    return precompute(std::move(mesh),
                      {.tolerance = scenes::Tolerance, .surface = everywhere(shiny(roughness))});
}

const glm::vec3 Eye(2.0f, 3.0f, 4.0f);

std::vector<glm::vec3> look(LiveEye& eye) {
    const auto radiance = eye.look(Eye);
    return {radiance.begin(), radiance.end()};
}

std::vector<glm::vec3> look_at(Scene scene) {
    LitScene lit(std::move(scene));
    lit.light(scenes::smooth_environment(32));
    LiveEye eye(lit);
    return look(eye);
}

TEST(LiveEye, RoughnessMayChangeAfterThePrecompute) {
    Scene changed = shiny_scene(0.2f);
    set_colors(changed, {.roughness = 0.6f});
    const std::vector<glm::vec3> expected = look_at(shiny_scene(0.6f));
    EXPECT_EQ(look_at(std::move(changed)), expected);
    EXPECT_NE(look_at(shiny_scene(0.2f)), expected);
}

TEST(LiveEye, RoughnessMayChangeWhileItLooks) {
    LitScene lit(shiny_scene(0.6f));
    lit.light(scenes::smooth_environment(32));
    LiveEye eye(lit);
    const std::vector<glm::vec3> rough = look(eye);
    for (const float roughness : {0.2f, 0.25f, 0.6f}) {
        lit.set_roughness(roughness);
        eye.take_surfaces();
        EXPECT_EQ(look(eye), look_at(shiny_scene(roughness))) << roughness;
    }
    EXPECT_EQ(look(eye), rough);
    EXPECT_THROW(lit.set_roughness(1.5f), std::invalid_argument);
    LitScene shared(std::make_shared<const Scene>(lit.scene()));
    EXPECT_THROW(shared.set_roughness(0.5f), std::logic_error);
}

TEST(LiveEye, ColoursMayChangeAfterThePrecompute) {
    Scene scene = shiny_scene(0.3f);
    set_colors(scene, {.albedo = glm::vec3(0.1f), .specular = glm::vec3(0.8f), .roughness = 0.5f});
    ASSERT_TRUE(has_live_highlights(scene));
    LitScene lit(std::move(scene));
    lit.light(scenes::smooth_environment(32));
    const LiveEye eye(lit);
    EXPECT_EQ(eye.surfaces()[0].albedo, glm::vec3(0.1f));
    EXPECT_EQ(eye.surfaces()[0].specular, glm::vec3(0.8f));
    EXPECT_EQ(eye.surfaces()[0].roughness_or_exponent, 0.5f);
}

TEST(LiveEye, RoughnessIsRefusedWhereNothingShines) {
    Scene matt =
        precompute(scenes::boulder(), {.tolerance = scenes::Tolerance,
                                       .surface = everywhere({.albedo = glm::vec3(0.5f)})});
    EXPECT_THROW(set_colors(matt, {.roughness = 0.5f}), std::invalid_argument);
    EXPECT_FALSE(has_live_highlights(matt));
    LitScene lit(std::move(matt));
    lit.light(scenes::smooth_environment(8));
    EXPECT_THROW(LiveEye{lit}, std::invalid_argument);
}

} // namespace
} // namespace relumine
