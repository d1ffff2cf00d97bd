#include "prt/glossy/brdf.h"
#include "relight/surfaces/surface_colors.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "prt/glossy/surface_sampling.h"
#include "relight/pictures/picture_view.h"
#include "tests/prt/textured_square.h"

namespace relumine::relight {
namespace {

/// The light of the vertices, linear over the square.
std::vector<glm::vec3> light(const mesh::TriangleMesh& mesh) {
    std::vector<glm::vec3> result;
    for (const glm::vec3& p : mesh.positions)
        result.emplace_back(2.0f + p.x, 3.0f + p.y, 1.0f);
    return result;
}

TEST(SurfaceColors, LightOfTheVerticesTimesTheTexture) {
    const mesh::TriangleMesh mesh = scenes::textured_square();
    std::vector<prt::Surface> surfaces = prt::vertex_surfaces(mesh);
    for (prt::Surface& surface : surfaces) // black keeps a trace
        surface.albedo = glm::max(surface.albedo, 1e-4f);
    std::vector<glm::vec3> radiance = light(mesh);
    for (std::size_t i = 0; i < radiance.size(); ++i)
        radiance[i] *= surfaces[i].albedo;
    const SurfaceColors colors(mesh, surfaces);
    for (std::uint32_t triangle = 0; triangle < 2; ++triangle)
        for (int i = 0; i <= 10; ++i) {
            const prt::MeshPoint point{.triangle = triangle,
                                       .barycentric = {0.05f * static_cast<float>(i), 0.4f}};
            ASSERT_TRUE(colors.has(triangle));
            const glm::vec3 p = prt::value_at(mesh, mesh.positions, point);
            const glm::vec3 expected =
                glm::vec3(2.0f + p.x, 3.0f + p.y, 1.0f) * colors.albedo(point);
            EXPECT_LT(glm::distance(colors.radiance(radiance, point), expected), 1e-5f);
        }
    // The second and third texel are on no vertex.
    EXPECT_EQ(colors.albedo({.triangle = 0, .barycentric = {0.375f, 0.0f}}), glm::vec3(1, 0, 0));
    EXPECT_EQ(colors.albedo({.triangle = 0, .barycentric = {0.625f, 0.0f}}), glm::vec3(0, 1, 0));
}

/// The light of the vertices as a function of the normal: L(w) = 1 + w.x, whose irradiance is pi +
/// 2 pi / 3 n.x.
TEST(SurfaceColors, NormalMapsTiltTheLightOfTheVertices) {
    const Camera camera{.eye = {0, 0, 4}, .target = {0, 0, 0}, .fov_degrees = 20.0f};
    const PictureOptions options{.width = 4, .height = 4, .samples_per_axis = 1};
    const auto drawn = [&](const mesh::TriangleMesh& mesh) {
        const prt::RayScene rays(mesh);
        const std::vector<prt::Surface> surfaces = prt::vertex_surfaces(mesh);
        const std::vector<glm::vec3> radiance(4, glm::vec3(0.5f));
        std::vector<glm::vec3> harmonics;
        for (int vertex = 0; vertex < 4; ++vertex) {
            const std::array<float, 4> light = {3.5449077f, 0.0f, 0.0f, 2.0466534f};
            for (const float coefficient : light)
                harmonics.emplace_back(coefficient);
        }
        const SurfaceColors textures(mesh, surfaces);
        return PictureView(mesh, rays, camera, options)
            .cut_out({.radiance = radiance, .textures = &textures, .harmonics = harmonics});
    };
    const glm::vec3 n = glm::normalize(glm::vec3(1, 0, 1));
    for (const glm::vec3& pixel : drawn(scenes::mapped_square({255, 128, 255})).pixels)
        EXPECT_NEAR(pixel.g, 0.5f * (1.0f + 2.0f / 3.0f * n.x), 1e-5f);
    mesh::TriangleMesh plain = scenes::mapped_square({128, 127, 255});
    const Picture flat = drawn(plain);
    plain.materials[0].normal_texture.reset();
    EXPECT_EQ(flat.pixels, drawn(plain).pixels) << "bit by bit";
    EXPECT_EQ(flat.pixels[5].g, 0.5f);
}

TEST(SurfaceColors, PicturesShowWhatIsFinerThanTheMesh) {
    const mesh::TriangleMesh mesh = scenes::textured_square();
    const prt::RayScene rays(mesh);
    const std::vector<prt::Surface> white(4);
    const std::vector<glm::vec3> radiance(4, glm::vec3(1.0f));
    const Camera camera{.eye = {0, 0, 4}, .target = {0, 0, 0}, .fov_degrees = 28.072487f};
    const PictureOptions options{.width = 8, .height = 8, .samples_per_axis = 1};
    const SurfaceColors textures(mesh, white);
    const PictureView view(mesh, rays, camera, options);
    const Picture picture = view.cut_out({.radiance = radiance, .textures = &textures});
    // The square fills the picture; two pixels a texel. Between its neighbours' centres a texel
    // is mixed with them: a quarter.
    for (std::size_t y = 1; y < 7; ++y) {
        const glm::vec3* row = picture.pixels.data() + 8 * y;
        EXPECT_GT(row[2].r, 0.7f);
        EXPECT_LT(row[2].g, 0.01f);
        EXPECT_GT(row[4].g, 0.7f);
        EXPECT_LT(row[4].b, 0.01f);
    }
    // A light that is traced shows them, too.
    const std::vector<glm::vec3> black(4, glm::vec3(0.0f));
    const glm::dvec3 w(0.0, 0.0, 3.14159265358979);
    const std::vector<SharpLight> lights = {{.direction = {0, 0, 1}, .irradiance = {w, w, w}}};
    const Picture traced = view.cut_out({.radiance = black,
                                         .lights = lights,
                                         .surfaces = white,
                                         .textures = &textures,
                                         .bias = 1e-4f});
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
        EXPECT_LT(glm::distance(traced.pixels[i], picture.pixels[i]), 1e-4f) << i;
    const Picture plain = view.cut_out({.radiance = radiance});
    EXPECT_EQ(plain.pixels[8 * 4 + 2], glm::vec3(1.0f)) << "without colours, the vertices'";
}

TEST(SurfaceColors, NothingWithoutTexturesOrSurfaces) {
    mesh::TriangleMesh mesh = scenes::textured_square();
    EXPECT_FALSE(SurfaceColors().has(0));
    EXPECT_FALSE(SurfaceColors(mesh, {}).has(0));
    mesh.triangle_materials = {0, 1};
    const std::vector<prt::Surface> white(4);
    const SurfaceColors half(mesh, white);
    EXPECT_FALSE(half.has(0));
    EXPECT_TRUE(half.has(1));
    mesh.triangle_materials.clear();
    EXPECT_FALSE(SurfaceColors(mesh, white).has(1));
}

TEST(SurfaceColors, HighlightsStayOnTopOfTextures) {
    mesh::TriangleMesh mesh = scenes::textured_square();
    for (mesh::Material& material : mesh.materials) {
        material.model = mesh::MaterialModel::MetallicRoughness;
        material.metallic = 0.0f;
    }
    const prt::RayScene rays(mesh);
    // A grey highlight over the vertices' own colour.
    const prt::Surface shiny{.albedo = glm::vec3(0.5f),
                             .specular = glm::vec3(0.04f),
                             .highlight = prt::Highlight::Ggx,
                             .roughness_or_exponent = 0.4f};
    const std::vector<prt::Surface> surfaces(4, shiny);
    std::vector<prt::Lobes<glm::vec3>> lobes(
        4, {.diffuse = glm::vec3(1.0f), .specular = glm::vec3(5.0f)});
    std::vector<glm::vec3> radiance(4, prt::reflect(shiny, lobes[0], 1.0f));
    const SurfaceColors textures(mesh, surfaces, true);
    const PictureView view(mesh, rays,
                           {.eye = {0, 0, 4}, .target = {0, 0, 0}, .fov_degrees = 28.072487f},
                           {.width = 8, .height = 8, .samples_per_axis = 1});
    const Picture picture = view.cut_out(
        {.radiance = radiance, .surfaces = surfaces, .textures = &textures, .lobes = lobes});
    const glm::vec3* row = picture.pixels.data() + 32;
    for (std::size_t x = 0; x < 8; ++x) {
        const float low = std::min({row[x].r, row[x].g, row[x].b});
        EXPECT_NEAR(low, 0.04f * 5.0f, 0.02f) << "the highlight alone where a colour is black";
    }
    EXPECT_GT(row[2].r, row[2].g + 0.5f);
    EXPECT_GT(row[4].g, row[4].b + 0.5f);

    // What the lobes do not tell counts as diffuse, and nothing is lost.
    radiance.assign(4, glm::vec3(2.0f, 0.9f, 3.0f));
    prt::Surface metal = shiny;
    metal.albedo = glm::vec3(0.0f);
    for (const prt::Surface& surface : {shiny, metal}) {
        std::vector<prt::Lobes<glm::vec3>> all = lobes;
        add_rest(radiance, std::vector(4, surface), std::vector<prt::EyeCosines>(4, 1.0f), all);
        EXPECT_LT(glm::distance(prt::reflect(surface, all[1], 1.0f), radiance[1]), 1e-5f);
    }
}

// Emission comes on top of all light: by the vertices, or at each pixel by the texture.
TEST(SurfaceColors, EmissionIsSeen) {
    mesh::TriangleMesh mesh = scenes::textured_square();
    const prt::RayScene rays(mesh);
    const PictureView view(mesh, rays,
                           {.eye = {0, 0, 4}, .target = {0, 0, 0}, .fov_degrees = 28.072487f},
                           {.width = 8, .height = 8, .samples_per_axis = 1});
    const std::vector<glm::vec3> black(4, glm::vec3(0.0f));
    std::vector<glm::vec3> emission(4, glm::vec3(3.0f, 0.0f, 0.5f));
    for (const glm::vec3& pixel : view.cut_out({.radiance = black, .emission = emission}).pixels)
        EXPECT_LT(glm::distance(pixel, emission[0]), 1e-5f);

    for (mesh::Material& material : mesh.materials) {
        material.model = mesh::MaterialModel::MetallicRoughness;
        material.emission = glm::vec3(2.0f);
        material.emission_texture = std::exchange(material.base_color_texture, {});
    }
    const std::vector<prt::Surface> surfaces = prt::vertex_surfaces(mesh);
    const SurfaceColors textures(mesh, surfaces);
    ASSERT_TRUE(textures.has(0)) << "a texture of emission is one";
    const std::vector<glm::vec3> gains(mesh.num_triangles(), glm::vec3(0.5f));
    const Picture picture = view.cut_out(
        {.radiance = black, .emission = emission, .emission_gains = gains, .textures = &textures});
    const glm::vec3* row = picture.pixels.data() + 32;
    EXPECT_GT(row[2].r, row[2].g + 0.5f) << "the textures' colours";
    EXPECT_GT(row[4].g, row[4].b + 0.5f);
    for (std::size_t x = 0; x < 8; ++x)
        EXPECT_LE(std::max({row[x].r, row[x].g, row[x].b}), 1.0f) << "2 times the factor";
}

} // namespace
} // namespace relumine::relight
