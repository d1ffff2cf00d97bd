// Lamps of a scene: against the path tracer, and their factors.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <vector>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "prt/receivers/receivers.h"
#include "relumine/ask/questions.h"
#include "relumine/relumine.h"
#include "tests/prt/scenes.h"

namespace relumine {
namespace {

/// n x n vertices of a parallelogram that faces cross(u, v).
void add_wall(mesh::TriangleMesh& mesh, std::uint32_t n, const glm::vec3& corner,
              const glm::vec3& u, const glm::vec3& v, std::uint32_t group) {
    const auto first = static_cast<std::uint32_t>(mesh.num_vertices());
    for (std::uint32_t i = 0; i < n * n; ++i) {
        const float s = static_cast<float>(i % n) / static_cast<float>(n - 1);
        const float t = static_cast<float>(i / n) / static_cast<float>(n - 1);
        mesh.positions.push_back(corner + s * u + t * v);
        mesh.normals.push_back(glm::normalize(glm::cross(u, v)));
    }
    for (std::uint32_t j = 0; j + 1 < n; ++j)
        for (std::uint32_t i = 0; i + 1 < n; ++i) {
            const std::uint32_t at = first + j * n + i;
            mesh.triangles.push_back({at, at + 1, at + n + 1});
            mesh.triangles.push_back({at, at + n + 1, at + n});
            mesh.triangle_groups.insert(mesh.triangle_groups.end(), {group, group});
            mesh.triangle_materials.insert(mesh.triangle_materials.end(), {group, group});
        }
}

/// A closed room of side 2 with a lamp close under its ceiling, a screen at a wall, and a table.
Scene closed_room() {
    mesh::TriangleMesh mesh;
    mesh.groups = {"room", "lamp", "screen"};
    const glm::vec3 grey(0.5f);
    mesh.materials = {{.name = "plaster", .base_color = grey},
                      {.name = "bulb", .base_color = grey, .emission = {9, 6, 3}},
                      {.name = "screen", .base_color = grey, .emission = {0, 1, 4}}};
    const glm::vec3 x(2, 0, 0), y(0, 2, 0), z(0, 0, 2), low(-1.0f), high(1.0f);
    const std::array<std::array<glm::vec3, 3>, 6> walls = {
        {{low, z, x}, {low, y, z}, {low, x, y}, {high, -x, -z}, {high, -z, -y}, {high, -y, -x}}};
    for (const auto& [corner, u, v] : walls)
        add_wall(mesh, 25, corner, u, v, 0);
    add_wall(mesh, 3, {-0.4f, 0.9f, -0.4f}, {0.8f, 0, 0}, {0, 0, 0.8f}, 1);
    add_wall(mesh, 3, {-0.98f, -0.5f, -0.3f}, {0, 0.4f, 0}, {0, 0, 0.6f}, 2);
    add_wall(mesh, 9, {-0.2f, -0.6f, -0.2f}, {0, 0, 0.8f}, {0.8f, 0, 0}, 0);
    PrecomputeOptions options{.tolerance = 0.05f, .min_level = 2, .no_refine = true};
    options.bounce_tolerance = 0.01f;
    return precompute(std::move(mesh), options);
}

const Scene& room() {
    static const Scene scene = closed_room();
    return scene;
}

LitScene lit_room(const std::vector<EmissionGain>& gains = {}) {
    LitScene lit(room());
    lit.dim(gains);
    lit.light(cubemap::CubeMap(8));
    lit.bounce({.albedo = bounce_albedo(lit.scene())});
    return lit;
}

std::vector<glm::vec3> light_of(const std::vector<EmissionGain>& gains) {
    const LitScene lit = lit_room(gains);
    return {lit.radiance().begin(), lit.radiance().end()};
}

TEST(SceneLamps, ARoomIsThatOfThePathTracer) {
    const Verification check =
        verify(lit_room(), {.num_samples = 60, .num_surface_points = 0, .num_paths = 1200});
    EXPECT_GT(check.error.mean_radiance, 0.1);
    const double l2 = check.error.relative_l2;
    EXPECT_LT(std::sqrt(std::max(l2 * l2 - check.noise * check.noise, 0.0)), 0.02);
    EXPECT_LT(check.noise, 0.02);
}

TEST(SceneLamps, FactorsAreWeightsOfASum) {
    const std::vector<glm::vec3> all = light_of({});
    const std::vector<glm::vec3> lamp = light_of({{"screen", glm::vec3(0.0f)}});
    const std::vector<glm::vec3> screen = light_of({{"lamp", glm::vec3(0.0f)}});
    LitScene lit = lit_room();
    lit.dim({{"lamp", {2, 1, 0}}, {"", glm::vec3(0.5f)}});
    double error = 0.0, noise = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const glm::dvec3 difference = glm::dvec3(lamp[i] + screen[i]) - glm::dvec3(all[i]);
        noise += glm::dot(difference, difference);
        squares += glm::dot(glm::dvec3(all[i]), glm::dvec3(all[i]));
        const glm::vec3 expected = glm::vec3(1.0f, 0.5f, 0.0f) * lamp[i] + 0.5f * screen[i];
        error = std::max(error, double{glm::distance(lit.radiance()[i], expected)});
    }
    EXPECT_LT(error, 2e-3);
    // Each has half-shadows of its own.
    EXPECT_LT(std::sqrt(noise / squares), 0.01);
    lit.dim({{.gain = glm::vec3(0.0f)}});
    for (const glm::vec3& value : lit.radiance())
        EXPECT_EQ(value, glm::vec3(0.0f));
}

TEST(SceneLamps, TheMixerGivesEachItsLayer) {
    const std::vector<EmissionGain> gains = {{"lamp", {2, 1, 0.5f}}};
    LitScene lit = lit_room(gains);
    OutputOptions options{.width = 32, .height = 24, .samples_per_axis = 1};
    options.eye = glm::vec3(0.9f, 0.0f, 0.9f);
    options.target = glm::vec3(0.0f);
    options.emission = gains;
    Painter painter(lit, options);
    const Picture before = painter.draw(lit.lighting());
    const relight::LayeredPicture mix = light_mix(lit, painter);
    ASSERT_EQ(mix.layers.size(), 3u);
    EXPECT_EQ(mix.layers[0].name, "environment");
    EXPECT_EQ(mix.layers[1].name, "lamp");
    EXPECT_EQ(mix.layers[2].name, "screen");
    double lamp = 0.0, screen = 0.0;
    for (std::size_t i = 0; i < before.pixels.size(); ++i) {
        EXPECT_EQ(mix.layers[0].pixels[i], glm::vec3(0.0f)) << "lamps are in no other layer";
        const glm::vec3 sum = mix.layers[1].pixels[i] + mix.layers[2].pixels[i];
        EXPECT_LT(glm::distance(sum, mix.whole.pixels[i]), 1e-4f);
        lamp += double{mix.layers[1].pixels[i].r};
        screen += double{mix.layers[2].pixels[i].r};
    }
    EXPECT_GT(lamp, 1.0);
    EXPECT_NEAR(screen, 0.0, 1e-6) << "it has no red";
    const Picture after = painter.draw(lit.lighting());
    EXPECT_EQ(after.pixels, before.pixels);
}

// Dimming there and back is no change, bit by bit, and a factor leaves no trace of others.
TEST(SceneLamps, AFactorIsTheSameOnAnyWay) {
    const std::vector<EmissionGain> half = {{"lamp", glm::vec3(0.5f)}};
    LitScene lit = lit_room();
    lit.dim(half);
    lit.dim({{"screen", glm::vec3(3.0f)}});
    lit.dim(half);
    EXPECT_THAT(lit.radiance(), testing::ElementsAreArray(light_of(half)));
    EXPECT_THROW(lit.dim({{"lmap", glm::vec3(2.0f)}}), std::invalid_argument);
    EXPECT_THAT(lit.radiance(), testing::ElementsAreArray(light_of(half)));
}

// A profile has the candela of its file and the light's colour; its own factor multiplies it.
TEST(SceneLamps, LightsGetProfiles) {
    const std::filesystem::path path =
        std::filesystem::path(testing::TempDir()) / "lights_get_profiles.ies";
    std::ofstream(path) << "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 5\n0 180\n0\n"
                           "7 7\n";
    Scene scene = room();
    scene.lamps = {};
    scene.lamps.lights = {
        {.name = "bulb", .intensity = {1, 2, 0.5f}, .position = {0.3f, 0.2f, 0.1f}},
        {.name = "sun", .kind = mesh::PunctualLight::Kind::Directional}};
    const EmissionGain off{"sun", glm::vec3(0.0f)},
        shaped = EmissionText::read("bulb=" + path.string());
    LitScene lit(scene);
    lit.dim({off});
    lit.light(cubemap::CubeMap(8));
    const std::vector<glm::vec3> point(lit.radiance().begin(), lit.radiance().end());
    const auto expect_times = [&](float factor) {
        for (std::size_t i = 0; i < point.size(); ++i)
            EXPECT_LT(glm::distance(lit.radiance()[i], factor * point[i]), 1e-4f);
    };
    lit.dim({off, shaped});
    expect_times(3.5f);
    lit.dim({off, shaped, {"bulb", glm::vec3(2.0f)}});
    expect_times(7.0f);
    lit.dim({off});
    expect_times(1.0f);
    EXPECT_THROW(lit.dim({EmissionText::read("sun=" + path.string())}), std::invalid_argument);
    EXPECT_THROW(lit.dim({EmissionText::read("bulb=none.ies")}), std::runtime_error);
    expect_times(1.0f);
    std::filesystem::remove(path);
}

TEST(SceneLamps, StayInTheFile) {
    const std::filesystem::path path =
        std::filesystem::path(testing::TempDir()) / "scene_lamps.prt";
    Scene scene = room();
    scene.lamps.lights = {{.name = "spot",
                           .kind = mesh::PunctualLight::Kind::Spot,
                           .intensity = {1, 2, 3},
                           .range = 4.0f,
                           .inner_cone = 0.1f,
                           .outer_cone = 0.2f},
                          {.name = "sun", .kind = mesh::PunctualLight::Kind::Directional}};
    save_scene(path, scene);
    EXPECT_EQ(load_scene(path).lamps, scene.lamps);
    scene.lamps.lights[0].range = -1.0f;
    EXPECT_THROW(save_scene(path, scene), std::runtime_error);
    std::filesystem::remove(path);
}

TEST(Emission, IsReadAndShown) {
    for (const char* text : {"0.5", "1,2,3", "lamp=0.5", "a=b=1,0.25,0.5,2", "a=b.ies"})
        EXPECT_EQ(EmissionText::show(EmissionText::read(text)), text);
    EXPECT_EQ(EmissionText::read("neon=2,1,0.5,0"), (EmissionGain{"neon", {2, 1, 0}}));
    for (const char* text : {"", "lamp=", "=1", "lamp=1,2,3", "lamp=-1", "lamp=x"})
        EXPECT_THROW(static_cast<void>(EmissionText::read(text)), std::invalid_argument) << text;
}

} // namespace
} // namespace relumine
