// Surfaces from materials: each model's numbers, textures, vertex colours, and which triangle a
// vertex listens to.
#include "prt/glossy/surface_sampling.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/prt/textured_square.h"

namespace relumine::prt {
namespace {

using mesh::Material;
using mesh::MaterialModel;

/// Two triangles of a square of side 1 in the plane y = 0, each with a material of its own.
mesh::TriangleMesh square(const Material& first, const Material& second = {}) {
    mesh::TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}, {5, 5, 5}};
    mesh.normals.assign(5, {0, 1, 0});
    mesh.triangles = {{0, 1, 2}, {2, 3, 0}};
    mesh.materials = {first, second};
    mesh.triangle_materials = {0, 1};
    return mesh;
}

/// 2 x 1 texels.
mesh::Texture two_texels(std::array<std::uint8_t, 3> left, std::array<std::uint8_t, 3> right) {
    return {.name = "two", .width = 2, .height = 1, .texels = {left, right}};
}

constexpr mesh::TextureSlot Clamped = {.wrap = {mesh::Wrap::Clamp, mesh::Wrap::Clamp}};

TEST(SurfaceSampling, LambertOfOneWithoutMaterials) {
    mesh::TriangleMesh mesh = square({});
    mesh.materials.clear();
    mesh.triangle_materials.clear();
    mesh.colors.assign(5, glm::vec3(0.5f));
    EXPECT_EQ(surface_at(mesh, 1, {0.2f, 0.3f}), Surface{});
    EXPECT_EQ(vertex_surfaces(mesh), std::vector<Surface>(5));
}

TEST(SurfaceSampling, MetallicRoughness) {
    const Material material = {.model = MaterialModel::MetallicRoughness,
                               .base_color = {1.0f, 0.5f, 0.25f},
                               .metallic = 0.25f,
                               .roughness = 0.375f};
    const Surface surface = surface_at(square(material), 0, {0.0f, 0.0f});
    EXPECT_EQ(surface.highlight, Highlight::GgxWhole);
    EXPECT_EQ(surface.metallic, 0.25f);
    const Surface published = surface_at(square(material), 0, {0.0f, 0.0f}, GgxForm::Published);
    EXPECT_EQ(published.highlight, Highlight::Ggx);
    EXPECT_EQ(published.metallic, 0.0f);
    EXPECT_EQ(published.specular, surface.specular);
    EXPECT_EQ(surface.roughness_or_exponent, 0.375f);
    EXPECT_EQ(surface.albedo, glm::vec3(0.75f, 0.375f, 0.1875f));
    EXPECT_NEAR(glm::distance(surface.specular, glm::vec3(0.28f, 0.155f, 0.0925f)), 0.0f, 1e-6f);
    Material metal = material;
    metal.metallic = 1.0f;
    EXPECT_EQ(surface_at(square(metal), 0, {}).albedo, glm::vec3(0.0f));
    EXPECT_EQ(surface_at(square(metal), 0, {}).specular, metal.base_color);
    metal.metallic = 0.0f;
    EXPECT_EQ(surface_at(square(metal), 0, {}).specular, glm::vec3(0.04f));
}

/// F0 takes its part of the diffuse colour, as KHR_materials_pbrSpecularGlossiness defines it; the
/// whole form takes what the highlight reflects in its place.
/// KHR_materials_ior and _specular: F0 = min(((n - 1) / (n + 1))^2 tint, 1) strength.
TEST(SurfaceSampling, DielectricsHaveTheirOwnF0) {
    mesh::TriangleMesh mesh = scenes::textured_square();
    mesh::Material& material = mesh.materials[1] = {.model = mesh::MaterialModel::MetallicRoughness,
                                                    .base_color = glm::vec3(0.5f)};
    const auto surface = [&] {
        return surface_at(mesh, 0, glm::vec2(0.25f));
    };
    EXPECT_EQ(surface().specular, glm::vec3(0.04f));
    material.ior = 1.33f;
    EXPECT_NEAR(surface().specular.g, 0.33f * 0.33f / (2.33f * 2.33f), 1e-7f);
    material.ior = 0.0f;
    EXPECT_EQ(surface().specular, glm::vec3(1.0f)) << "infinite";
    material.ior = 3.0f;
    material.specular_tint = {1.0f, 0.5f, 8.0f};
    material.specular_strength = 0.5f;
    EXPECT_EQ(surface().specular, glm::vec3(0.125f, 0.0625f, 0.5f));
    EXPECT_EQ(surface().dielectric_f90, 0.5f);
    material.metallic = 0.5f;
    EXPECT_EQ(surface().specular, glm::vec3(0.3125f, 0.28125f, 0.5f));
    EXPECT_EQ(surface().dielectric_f0, 0.5f);
}

TEST(SurfaceSampling, LayersHaveTheirTextures) {
    mesh::TriangleMesh mesh = scenes::textured_square();
    const mesh::TextureSlot colors{.texture = 0, .wrap = {mesh::Wrap::Clamp, {}}};
    mesh.materials[1] = {.model = mesh::MaterialModel::MetallicRoughness,
                         .coat = 0.5f,
                         .coat_texture = colors,
                         .coat_roughness = 0.25f,
                         .coat_roughness_texture = colors,
                         .sheen = {1.0f, 0.5f, 0.25f},
                         .sheen_texture = colors,
                         .sheen_roughness = 0.75f};
    // Black, red, green and blue, at the middles of the texels.
    const Surface red = surface_at(mesh, 0, {0.375f, 0.0f}),
                  green = surface_at(mesh, 0, {0.625f, 0.0f});
    EXPECT_EQ(red.coat, 0.5f);
    EXPECT_EQ(red.coat_roughness, 0.0f);
    EXPECT_EQ(green.coat, 0.0f);
    EXPECT_EQ(green.coat_roughness, 0.25f);
    EXPECT_EQ(red.sheen, glm::vec3(1, 0, 0));
    EXPECT_EQ(green.sheen, glm::vec3(0, 0.5f, 0));
    EXPECT_EQ(green.sheen_roughness, 0.75f);
    const Surface plain = without_highlight(red);
    EXPECT_EQ(plain.coat, 0.0f);
    EXPECT_EQ(plain.sheen, glm::vec3(0.0f));
    EXPECT_LT(plain.albedo.g, red.albedo.g) << "sheen takes light";
}

/// The texture's red is how much of the film there is, its green how thick it is.
TEST(SurfaceSampling, FilmsHaveTheirTextures) {
    mesh::TriangleMesh mesh = scenes::textured_square();
    const mesh::TextureSlot colors{.texture = 0, .wrap = {mesh::Wrap::Clamp, {}}};
    mesh.materials[1] = {.model = mesh::MaterialModel::MetallicRoughness,
                         .film = 0.5f,
                         .film_ior = 1.75f,
                         .film_thickness_at_0 = 600.0f};
    const auto red = [&] {
        return surface_at(mesh, 0, {0.375f, 0.0f});
    };
    EXPECT_EQ(red().film, 0.5f);
    EXPECT_EQ(red().film_ior, 1.75f);
    EXPECT_EQ(red().film_thickness, 400.0f) << "without a texture: as where green is 1";
    mesh.materials[1].film_texture = mesh.materials[1].film_thickness_texture = colors;
    EXPECT_EQ(red().film, 0.5f);
    EXPECT_EQ(red().film_thickness, 600.0f);
    const Surface green = surface_at(mesh, 0, {0.625f, 0.0f});
    EXPECT_EQ(green.film, 0.0f);
    EXPECT_EQ(green.film_thickness, 400.0f);
    EXPECT_EQ(without_highlight(red()).film, 0.0f);
}

/// The tangent is along u. The rotation turns it towards the bitangent, and so does the texture.
TEST(SurfaceSampling, TheTangentTurns) {
    mesh::TriangleMesh mesh = scenes::mapped_square({255, 128, 255});
    mesh::Material& material = mesh.materials[0];
    const mesh::TextureSlot map = *material.normal_texture;
    material = {.model = mesh::MaterialModel::MetallicRoughness, .anisotropy = 0.5f};
    const auto surface = [&] {
        return surface_at(mesh, 0, {0.25f, 0.25f});
    };
    const glm::vec3 along(mesh.corner_tangents[0][0]);
    const glm::vec3 across = mesh.corner_tangents[0][0].w * glm::cross(mesh.normals[0], along);
    EXPECT_EQ(surface().anisotropy, 0.5f);
    EXPECT_NEAR(glm::dot(surface().tangent, along), 1.0f, 1e-6f);
    material.anisotropy_rotation = 0.5f;
    EXPECT_NEAR(glm::dot(surface().tangent, along), std::cos(0.5f), 1e-6f);
    EXPECT_NEAR(glm::dot(surface().tangent, across), std::sin(0.5f), 1e-6f);
    material.anisotropy_texture = map;
    mesh.textures[map.texture] =
        mesh::Texture{.name = {}, .width = 1, .height = 1, .texels = {{128, 255, 51}}};
    EXPECT_NEAR(surface().anisotropy, 0.1f, 1e-6f);
    EXPECT_NEAR(glm::dot(surface().tangent, along), -std::sin(0.5f), 0.005f);
    EXPECT_NEAR(glm::dot(surface().tangent, across), std::cos(0.5f), 0.005f);
    mesh.corner_tangents.clear();
    EXPECT_EQ(surface().anisotropy, 0.0f) << "there is no tangent";
}

TEST(SurfaceSampling, SpecularGlossiness) {
    Material material = {.model = MaterialModel::SpecularGlossiness,
                         .base_color = {1.0f, 0.5f, 0.25f},
                         .roughness = 0.375f,
                         .specular = {0.25f, 0.5f, 0.125f}};
    EXPECT_EQ(surface_at(square(material), 0, {}, GgxForm::Published),
              (Surface{.albedo = {0.5f, 0.25f, 0.125f},
                       .specular = {0.25f, 0.5f, 0.125f},
                       .highlight = Highlight::Ggx,
                       .roughness_or_exponent = 0.375f}));
    EXPECT_EQ(surface_at(square(material), 0, {}), (Surface{.albedo = {1.0f, 0.5f, 0.25f},
                                                            .specular = {0.25f, 0.5f, 0.125f},
                                                            .highlight = Highlight::GgxWhole,
                                                            .roughness_or_exponent = 0.375f}));
    mesh::TriangleMesh mesh = square(material);
    mesh.textures = {two_texels({255, 0, 255}, {255, 0, 255})};
    mesh.materials[0].specular_texture = Clamped;
    EXPECT_EQ(surface_at(mesh, 0, {}).specular, glm::vec3(0.25f, 0.0f, 0.125f));
    EXPECT_EQ(surface_at(mesh, 0, {}, GgxForm::Published).albedo,
              glm::vec3(0.75f, 0.375f, 0.1875f));
}

TEST(SurfaceSampling, EmissionAndUnlit) {
    mesh::TriangleMesh mesh = square({.model = MaterialModel::MetallicRoughness,
                                      .metallic = 0.0f,
                                      .emission = {4.0f, 2.0f, 0.0f},
                                      .emission_texture = Clamped});
    mesh.textures = {two_texels({255, 0, 255}, {255, 0, 255})};
    EXPECT_EQ(surface_at(mesh, 0, {}).emission, glm::vec3(4.0f, 0.0f, 0.0f));
    EXPECT_EQ(surface_at(mesh, 0, {}).albedo, glm::vec3(1.0f)) << "it still reflects";
    // The colours of vertices multiply it, also where they are brighter than white.
    mesh.materials[0] = {.model = MaterialModel::Unlit,
                         .base_color = {1.0f, 0.5f, 0.25f},
                         .times_vertex_color = true};
    mesh.colors.assign(mesh.num_vertices(), glm::vec3(1.0f, 4.0f, 1.0f));
    EXPECT_EQ(surface_at(mesh, 0, {}),
              (Surface{.albedo = glm::vec3(0.0f), .emission = {1.0f, 2.0f, 0.25f}}));
}

TEST(SurfaceSampling, PhongIsLambertWithoutKs) {
    const Material matt = {.base_color = glm::vec3(0.5f), .exponent = 30.0f};
    Material shiny = matt;
    shiny.specular = {0.0f, 0.25f, 0.0f};
    const mesh::TriangleMesh mesh = square(matt, shiny);
    EXPECT_EQ(surface_at(mesh, 0, {}), (Surface{.albedo = glm::vec3(0.5f)}));
    EXPECT_EQ(surface_at(mesh, 1, {}), (Surface{.albedo = glm::vec3(0.5f),
                                                .specular = {0.0f, 0.25f, 0.0f},
                                                .highlight = Highlight::BlinnPhong,
                                                .roughness_or_exponent = 30.0f}));
}

TEST(SurfaceSampling, TexturesAtBarycentricPlaces) {
    Material material = {.model = MaterialModel::MetallicRoughness,
                         .base_color = glm::vec3(0.5f),
                         .metallic = 0.5f,
                         .roughness = 0.5f};
    material.base_color_texture = Clamped;
    material.metallic_roughness_texture = Clamped;
    material.metallic_roughness_texture->texture = 1;
    mesh::TriangleMesh mesh = square(material, material);
    mesh.textures = {two_texels({255, 0, 0}, {0, 0, 255}), two_texels({0, 0, 255}, {0, 255, 0})};
    mesh.uvs = {{0.25f, 0.5f}, {0.75f, 0.5f}, {0.25f, 0.5f}, {0.25f, 0.5f}, {0, 0}};
    // At the second corner of triangle 0: the right texels; half way there from the first: both,
    // evenly.
    const Surface corner = surface_at(mesh, 0, {1.0f, 0.0f});
    EXPECT_EQ(corner.roughness_or_exponent, 0.5f) << "green is roughness";
    EXPECT_EQ(corner.albedo, glm::vec3(0.0f, 0.0f, 0.5f)) << "blue, metallic, is 0";
    const Surface middle = surface_at(mesh, 0, {0.5f, 0.25f});
    EXPECT_EQ(middle.roughness_or_exponent, 0.25f);
    EXPECT_EQ(middle.albedo, glm::vec3(0.1875f, 0.0f, 0.1875f)) << "metallic 1/4";
    // uvs of corners come before those of vertices.
    mesh.corner_uvs = {{{{0.75f, 0.5f}, {0.25f, 0.5f}, {0.25f, 0.5f}}}, {{{0, 0}, {0, 0}, {0, 0}}}};
    EXPECT_EQ(surface_at(mesh, 0, {0.0f, 0.0f}).roughness_or_exponent, 0.5f);
    EXPECT_EQ(surface_at(mesh, 0, {1.0f, 0.0f}).roughness_or_exponent, 0.0f);
}

TEST(SurfaceSampling, VertexColorsAreAFactorOfGltf) {
    Material material = {.base_color = glm::vec3(0.5f), .times_vertex_color = true};
    mesh::TriangleMesh mesh = square(material, {});
    EXPECT_EQ(surface_at(mesh, 0, {}).albedo, glm::vec3(0.5f)) << "no colours";
    mesh.colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {1, 1, 1}};
    EXPECT_EQ(surface_at(mesh, 0, {0.25f, 0.25f}).albedo, glm::vec3(0.25f, 0.125f, 0.125f));
    EXPECT_EQ(surface_at(mesh, 1, {0.25f, 0.25f}).albedo, glm::vec3(1.0f));
}

TEST(SurfaceSampling, VerticesListenToTheirLowestTriangle) {
    const mesh::TriangleMesh mesh =
        square({.base_color = glm::vec3(0.25f)}, {.base_color = glm::vec3(0.75f)});
    const std::vector<Surface> surfaces = vertex_surfaces(mesh);
    for (const std::size_t vertex : {0u, 1u, 2u})
        EXPECT_EQ(surfaces[vertex].albedo, glm::vec3(0.25f)) << vertex;
    EXPECT_EQ(surfaces[3].albedo, glm::vec3(0.75f));
    EXPECT_EQ(surfaces[4], Surface{}) << "no triangle";

    const std::vector<Surface> overridden = vertex_surfaces(
        mesh, [](const mesh::TriangleMesh&, std::uint32_t triangle, const Surface& surface) {
            Surface other = surface;
            if (triangle == 0)
                other.albedo *= 2.0f;
            return other;
        });
    EXPECT_EQ(overridden[2].albedo, glm::vec3(0.5f));
    EXPECT_EQ(overridden[3].albedo, glm::vec3(0.75f));
}

TEST(SurfaceSampling, MetalsAreNotBlackWithoutTheirHighlights) {
    const glm::vec3 base(0.91f, 0.33f, 0.02f);
    const Surface metal = without_highlight(
        {.albedo = glm::vec3(0.0f), .specular = base, .highlight = Highlight::Ggx});
    EXPECT_EQ(metal.highlight, Highlight::None);
    EXPECT_EQ(metal.albedo, glm::vec3(0.91f - 0.04f, 0.33f - 0.04f, 0.0f));
    const Surface paint = without_highlight(
        {.albedo = base, .specular = glm::vec3(0.04f), .highlight = Highlight::Ggx});
    EXPECT_EQ(paint.albedo, base);
    const Surface phong = without_highlight(
        {.albedo = base, .specular = glm::vec3(0.5f), .highlight = Highlight::BlinnPhong});
    EXPECT_EQ(phong.albedo, base);
    EXPECT_EQ(without_highlight({.albedo = base, .specular = glm::vec3(0.5f)}).albedo, base);
}

TEST(Widen, AddsTheSpreadOfNormalsToTheLobes) {
    const auto alpha_of = [](float roughness) {
        return roughness * roughness;
    };
    Surface metal{.highlight = Highlight::GgxWhole,
                  .roughness_or_exponent = 0.3f,
                  .coat = 0.5f,
                  .coat_roughness = 0.1f};
    const Surface before = metal;
    widen(metal, 0.0f, 0.0f);
    EXPECT_EQ(metal, before);
    widen(metal, 0.01f, 0.01f);
    EXPECT_NEAR(std::pow(alpha_of(metal.roughness_or_exponent), 2.0f), 0.0081f + 0.002f, 1e-5f);
    EXPECT_NEAR(std::pow(alpha_of(metal.coat_roughness), 2.0f), 0.0001f + 0.002f, 1e-5f);
    widen(metal, 1.0f, 1.0f);
    EXPECT_LE(metal.roughness_or_exponent, 1.0f);
    Surface phong{.highlight = Highlight::BlinnPhong, .roughness_or_exponent = 198.0f};
    widen(phong, 0.01f, 0.01f); // as wide as GGX of alpha^2 = 2 / (exponent + 2)
    EXPECT_NEAR(phong.roughness_or_exponent, 98.0f, 0.01f);
    Surface matte;
    widen(matte, 0.5f, 0.5f);
    EXPECT_EQ(matte, Surface());
}

} // namespace
} // namespace relumine::prt
