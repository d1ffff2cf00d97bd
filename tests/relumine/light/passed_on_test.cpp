// Light that surfaces pass on from behind them: leaves, paper, lampshades.
#include <filesystem>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "data_gen/environments.h"
#include "relumine/in/precompute.h"
#include "relumine/light/lit_scene.h"
#include "relumine/out/output.h"
#include "tests/own_folder.h"
#include "tests/prt/scenes.h"

namespace relumine {
namespace {

constexpr float Part = 0.25f;
const glm::vec3 Base(0.8f, 0.6f, 0.2f), Passed(0.5f, 1.0f, 0.125f);

mesh::Material leaf(float part = Part, const glm::vec3& base = Base,
                    const glm::vec3& passed = Passed) {
    return {.name = "leaf",
            .model = mesh::MaterialModel::MetallicRoughness,
            .base_color = base,
            .diffuse_transmission = part,
            .diffuse_transmission_color = passed,
            .specular_strength = 0.0f};
}

/// A level sheet of nine vertices.
mesh::TriangleMesh sheet_of(const mesh::Material& material) {
    mesh::TriangleMesh mesh = scenes::floor_grid(3, 1.0f);
    mesh.materials = {material};
    mesh.triangle_materials.assign(mesh.num_triangles(), 0);
    return mesh;
}

/// Two skies that meet at the horizon.
cubemap::CubeMap two_skies(float above, float below) {
    cubemap::CubeMap map(16);
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < 16; ++y)
            for (std::uint32_t x = 0; x < 16; ++x)
                map.at(face, x, y) =
                    glm::vec3(cubemap::texel_direction(face, x, y, 16).y > 0.0 ? above : below);
    return map;
}

Scene scene_of(const mesh::TriangleMesh& mesh, float bounces = 0.0f) {
    return precompute(mesh, {.bounce_tolerance = bounces});
}

/// Draws the sheet from above, or from below, and returns the middle pixel.
glm::vec3 seen(const LitScene& lit, bool from_above) {
    OutputOptions options;
    options.width = options.height = 16;
    options.camera = Camera{.eye = {0.03f, from_above ? 4.0f : -4.0f, 0.01f}, .target = {0, 0, 0}};
    options.background = NothingBehind{};
    const Picture picture = draw(lit, options);
    return picture.pixels[8 * 16 + 8];
}

void expect_near(const glm::vec3& actual, const glm::vec3& expected, float tolerance) {
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(actual[channel], expected[channel], tolerance) << channel;
}

TEST(PassedOn, IsTheCosineLightOfTheOtherSide) {
    LitScene lit(scene_of(sheet_of(leaf())));
    EXPECT_EQ(lit.scene().mesh.num_triangles(), 16u);
    lit.light(two_skies(2.0f, 3.0f));
    const glm::vec3 of_front = Base * (1.0f - Part) * 2.0f + Passed * Part * 3.0f,
                    of_back = Base * (1.0f - Part) * 3.0f + Passed * Part * 2.0f;
    for (std::size_t i = 0; i < lit.radiance().size(); ++i)
        expect_near(lit.radiance()[i], lit.scene().mesh.normals[i].y > 0.0f ? of_front : of_back,
                    0.01f);
    expect_near(seen(lit, true), of_front, 0.01f);
    expect_near(seen(lit, false), of_back, 0.01f);
    lit.light(two_skies(0.0f, 3.0f));
    expect_near(seen(lit, true), Passed * Part * 3.0f, 0.01f);
}

/// The whole of the light passes: nothing is reflected.
TEST(PassedOn, ABlackSheetShinesThrough) {
    LitScene lit(scene_of(sheet_of(leaf(1.0f, glm::vec3(0.0f)))));
    lit.light(two_skies(5.0f, 3.0f));
    expect_near(seen(lit, true), Passed * 3.0f, 0.01f);
    expect_near(lit.radiance()[4], Passed * 3.0f, 0.01f);
}

TEST(PassedOn, ReflectedAndPassedOnAreAllInAFurnace) {
    for (const float strength : {0.0f, 1.0f}) {
        mesh::Material paper = leaf(0.4f, glm::vec3(1.0f), glm::vec3(1.0f));
        paper.specular_strength = strength;
        paper.roughness = 0.5f;
        LitScene lit(scene_of(sheet_of(paper)));
        lit.light(data_gen::constant(16, glm::vec3(1.0f)));
        expect_near(seen(lit, true), glm::vec3(1.0f), 0.01f);
        expect_near(seen(lit, false), glm::vec3(1.0f), 0.01f);
    }
}

/// Lights that pictures trace at each pixel, on either side.
TEST(PassedOn, ASunBehindTheSheet) {
    LitScene lit(scene_of(sheet_of(leaf())));
    const glm::dvec3 below = glm::normalize(glm::dvec3(0.0, -4.0, 3.0));
    lit.light(
        std::vector<lights::DistantLight>{{.direction = below, .irradiance = glm::dvec3(10.0)}});
    const auto on_back = static_cast<float>(10.0 * 0.8 / std::numbers::pi);
    expect_near(seen(lit, true), Passed * Part * on_back, 0.001f);
    expect_near(seen(lit, false), Base * (1.0f - Part) * on_back, 0.001f);
    expect_near(lit.radiance()[4], Passed * Part * on_back, 0.001f);
}

/// Light comes from every side, and nothing is lost: a hollow body of white paper is white, inside
/// too, if what it passes on bounces on.
TEST(PassedOn, AHollowBodyOfWhitePaperIsWhite) {
    mesh::TriangleMesh lantern = scenes::icosphere(3, 1.0f, glm::vec3(0.0f));
    lantern.materials = {leaf(0.5f, glm::vec3(1.0f), glm::vec3(1.0f))};
    lantern.triangle_materials.assign(lantern.num_triangles(), 0);
    LitScene lit(scene_of(lantern, 0.02f));
    lit.light(data_gen::constant(16, glm::vec3(1.0f)));
    EXPECT_NEAR(lit.radiance()[0].g, 0.5f, 0.01f) << "the inside is dark without bounces";
    lit.bounce({.albedo = bounce_albedo(lit.scene()), .limits = {.tolerance = 1e-4}});
    // The mean, since each receiver samples what it sees.
    double outside = 0.0, inside = 0.0;
    const auto half = static_cast<double>(lit.radiance().size()) / 2.0;
    for (std::size_t i = 0; i < lit.radiance().size(); ++i) {
        const bool is_outside =
            glm::dot(lit.scene().mesh.normals[i], lit.scene().mesh.positions[i]) > 0.0f;
        (is_outside ? outside : inside) += static_cast<double>(lit.radiance()[i].g) / half;
    }
    EXPECT_NEAR(outside, 1.0, 0.02);
    EXPECT_NEAR(inside, 1.0, 0.02);
}

/// The sheet and its back are one surface to the eye.
TEST(PassedOn, ABlendedSheetCoversOnce) {
    mesh::Material thin = leaf();
    thin.alpha_mode = mesh::AlphaMode::Blend;
    thin.alpha = 0.5f;
    LitScene lit(scene_of(sheet_of(thin)));
    lit.light(two_skies(2.0f, 3.0f));
    expect_near(seen(lit, true), 0.5f * (Base * (1.0f - Part) * 2.0f + Passed * Part * 3.0f),
                0.02f);
}

class PassedOnFile : public tests::FolderTest {};

TEST_F(PassedOnFile, KeepsIt) {
    const std::filesystem::path path = folder_ / "leaf.prt";
    static_cast<void>(precompute(sheet_of(leaf()), {.bounce_tolerance = 0.0f, .output = path}));
    LitScene lit(load_scene(path));
    lit.light(two_skies(0.0f, 3.0f));
    expect_near(seen(lit, true), Passed * Part * 3.0f, 0.01f);
}

TEST(PassedOn, PixelsSayThatTheyLackIt) {
    std::vector<Warning> warnings;
    PrecomputeWork work;
    work.on_warning = [&](Warning kind, const std::string&) {
        warnings.push_back(kind);
    };
    static_cast<void>(precompute(sheet_of(leaf()),
                                 {.receivers = Pixels{.width = 8, .height = 8},
                                  .view = View{.camera = Camera{.eye = {0, 4, 0.1f}}}},
                                 work));
    EXPECT_EQ(warnings, (std::vector{Warning::PassedOnLight}));
    warnings.clear();
    static_cast<void>(precompute(sheet_of(leaf()), {.bounce_tolerance = 0.0f}, work));
    EXPECT_TRUE(warnings.empty());
}

TEST(PassedOn, MaterialsOfOptionsHaveNone) {
    PrecomputeOptions options{.surface = everywhere({.albedo = glm::vec3(0.5f)}),
                              .bounce_tolerance = 0.0f};
    LitScene lit(precompute(sheet_of(leaf()), options));
    lit.light(two_skies(2.0f, 3.0f));
    expect_near(seen(lit, true), glm::vec3(1.0f), 0.01f);
}

} // namespace
} // namespace relumine
