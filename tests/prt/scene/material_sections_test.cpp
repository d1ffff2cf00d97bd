#include <cmath>

#include <gtest/gtest.h>

#include "mesh/opacity.h"
#include "prt/glossy/surface_sampling.h"
#include "prt/scene/section_group.h"
#include "tests/prt/damaged_file.h"
#include "tests/prt/leaf_card.h"
#include "tests/prt/made_sections.h"
#include "tests/prt/scenes.h"
#include "tests/prt/textured_square.h"

namespace relumine::prt {
namespace {

/// A mesh of the same triangles, read from the sections.
mesh::TriangleMesh read(Sections sections, const mesh::TriangleMesh& from) {
    Scene scene;
    mesh::TriangleMesh& result = scene.mesh;
    result.positions = from.positions;
    result.normals = from.normals;
    result.triangles = from.triangles;
    result.uvs = from.uvs;
    MaterialSections.read(scenes::reader_of("scene.prt", std::move(sections)), scene);
    return scene.mesh;
}

Sections written(const mesh::TriangleMesh& mesh) {
    NewSections sections;
    Scene scene;
    scene.mesh = mesh;
    scene.receivers.surfaces.resize(1); // textures are for surfaces
    MaterialSections.add(sections, scene);
    return scenes::made(sections);
}

void expect_same_colors(const mesh::TriangleMesh& a, const mesh::TriangleMesh& b) {
    for (std::uint32_t triangle = 0; triangle < a.num_triangles(); ++triangle)
        for (int i = 0; i <= 20; ++i) {
            const glm::vec2 point(0.02f * static_cast<float>(i), 0.3f);
            const Surface one = surface_at(a, triangle, point),
                          other = surface_at(b, triangle, point);
            EXPECT_EQ(one.albedo, other.albedo);
            EXPECT_EQ(one.emission, other.emission);
        }
}

TEST(MaterialSections, UvsOfCornersAreFinite) {
    const std::filesystem::path path = "scene.prt";
    Scene scene;
    scene.mesh = scenes::textured_square();
    scene.mesh.corner_uvs.resize(scene.mesh.num_triangles());
    MaterialSections.check(SceneCheck(path), scene);
    scene.mesh.corner_uvs[1][2].y = NAN;
    scenes::expect_refused(path, "finite uvs of corners, got element 1",
                           [&] { MaterialSections.check(SceneCheck(path), scene); });
}

TEST(MaterialSections, KeepNormalMaps) {
    mesh::TriangleMesh mesh = scenes::mapped_square({255, 128, 255});
    mesh.materials[0].normal_scale = 0.5f;
    mesh.materials[0].ior = 1.25f;
    mesh.materials[0].specular_tint = {2.0f, 0.5f, 0.0f};
    mesh.materials[0].normal_texture->uv_set = 1;
    mesh.materials[0].base_color_texture = mesh::TextureSlot{.texture = 0, .is_srgb = true};
    const mesh::TriangleMesh same = read(written(mesh), mesh);
    EXPECT_EQ(same.corner_tangents, mesh.corner_tangents);
    EXPECT_EQ(same.materials[0].normal_texture, mesh.materials[0].normal_texture);
    EXPECT_EQ(same.materials[0].normal_scale, 0.5f);
    EXPECT_EQ(same.materials[0].ior, 1.25f);
    EXPECT_EQ(same.materials[0].specular_strength, 1.0f);
    EXPECT_EQ(same.materials[0].specular_tint, mesh.materials[0].specular_tint);
    const std::filesystem::path path = "scene.prt";
    Scene scene;
    scene.mesh = mesh;
    scene.mesh.corner_tangents[1][2].w = NAN;
    scenes::expect_refused(path, "finite tangents, got element 1",
                           [&] { MaterialSections.check(SceneCheck(path), scene); });
}

TEST(MaterialSections, KeepLayersAndAnisotropy) {
    mesh::TriangleMesh mesh = scenes::mapped_square({255, 128, 255});
    mesh::Material& material = mesh.materials[0];
    material.model = mesh::MaterialModel::MetallicRoughness;
    material.coat = 0.75f;
    material.coat_roughness = 0.25f;
    material.coat_normal_scale = -2.0f;
    material.sheen = {1.0f, 0.5f, 0.0f};
    material.sheen_roughness = 0.5f;
    material.film = 0.5f;
    material.film_ior = 1.75f;
    material.film_thickness_at_0 = 900.0f;
    material.anisotropy = 0.25f;
    material.anisotropy_rotation = -0.5f;
    for (const auto slot :
         {&mesh::Material::coat_texture, &mesh::Material::coat_roughness_texture,
          &mesh::Material::coat_normal_texture, &mesh::Material::sheen_texture,
          &mesh::Material::sheen_roughness_texture, &mesh::Material::specular_strength_texture,
          &mesh::Material::specular_tint_texture, &mesh::Material::film_texture,
          &mesh::Material::film_thickness_texture, &mesh::Material::anisotropy_texture})
        material.*slot = material.normal_texture;
    mesh::Material same = read(written(mesh), mesh).materials.at(0);
    same.name = material.name;
    EXPECT_EQ(same, material);
}

TEST(MaterialSections, KeepTheColoursOfEveryPoint) {
    mesh::TriangleMesh mesh = scenes::textured_square();
    mesh.triangle_materials = {1, 0};
    const mesh::TriangleMesh same = read(written(mesh), mesh);
    EXPECT_EQ(same.textures[0].texels, mesh.textures[0].texels);
    EXPECT_EQ(same.textures[0].file, mesh.textures[0].file) << "the image as it was";
    EXPECT_EQ(same.triangle_materials, mesh.triangle_materials);
    expect_same_colors(same, mesh);

    // Metal takes its part of the colour; uvs of corners.
    mesh.corner_uvs = {{{{0, 0}, {0.5f, 0}, {0.5f, 1}}}, {{{0.5f, 0}, {1, 1}, {0.5f, 1}}}};
    mesh.triangle_materials = {1, 1};
    mesh.materials[1].model = mesh::MaterialModel::MetallicRoughness;
    mesh.materials[1].metallic = 0.75f;
    mesh.materials[1].metallic_roughness_texture = mesh.materials[1].base_color_texture;
    expect_same_colors(read(written(mesh), mesh), mesh);
    mesh.materials[1].model = mesh::MaterialModel::SpecularGlossiness;
    mesh.materials[1].specular = glm::vec3(0.5f, 0.25f, 0.125f);
    mesh.materials[1].specular_texture = mesh.materials[1].base_color_texture;
    mesh.materials[1].specular_texture->uv_from_mesh_uv = glm::mat2(0, 1, 2, 0);
    mesh.materials[1].specular_texture->uv_offset = glm::vec2(0.25f, 0.5f);
    expect_same_colors(read(written(mesh), mesh), mesh);

    // A texture of emission alone is one; unlit colours stay unlit.
    mesh.materials[1] = {.emission = glm::vec3(4.0f, 0.5f, 0.0f),
                         .emission_texture = mesh.materials[1].base_color_texture};
    expect_same_colors(read(written(mesh), mesh), mesh);
    EXPECT_EQ(read(written(mesh), mesh).materials[1].emission, mesh.materials[1].emission);
    mesh.materials[1] = {.model = mesh::MaterialModel::Unlit,
                         .base_color_texture = mesh.materials[1].emission_texture};
    expect_same_colors(read(written(mesh), mesh), mesh);
}

TEST(MaterialSections, AreOnlyForTextures) {
    mesh::TriangleMesh mesh = scenes::textured_square();
    mesh.materials[1].base_color_texture.reset();
    EXPECT_TRUE(written(mesh).empty());
    EXPECT_TRUE(read({}, mesh).materials.empty()) << "files without them are good";
}

TEST(MaterialSections, KeepWhatRaysPass) {
    Scene scene;
    scene.mesh = scenes::with_card(scenes::floor_grid(3, 2.0f), scenes::leaf_card(2, 1.0f, 1.0f));
    scene.mesh.materials[0] = {.is_double_sided = false};
    scene.mesh.materials[0].transmission = 0.5f;
    scene.mesh.materials[0].thickness = 0.25f;
    scene.mesh.materials[0].attenuation_color = glm::vec3(0.5f);
    scene.mesh.materials[0].attenuation_distance = 3.0f;
    scene.mesh.materials[0].dispersion = 0.36f;
    scene.mesh.materials[1].alpha = 0.75f;
    scene.mesh.materials[1].alpha_cutoff = 0.25f;
    scene.blockers = mesh::blockers_of(scene.mesh);
    scene.layout = PointLayout{};
    NewSections sections;
    MaterialSections.add(sections, scene);
    Scene same;
    same.mesh.positions = scene.mesh.positions;
    same.mesh.triangles = scene.mesh.triangles;
    same.mesh.uvs = scene.mesh.uvs;
    same.blockers = same.mesh;
    same.blockers->uvs.clear();
    MaterialSections.read(scenes::reader_of("scene.prt", scenes::made(sections)), same);
    EXPECT_FALSE(same.mesh.materials[0].is_double_sided);
    EXPECT_EQ(same.mesh.materials[0].dispersion, 0.36f);
    for (const mesh::TriangleMesh& mesh : {same.mesh, *same.blockers})
        for (int i = 0; i < 100; ++i) {
            const auto triangle = static_cast<std::uint32_t>(i % 10);
            const glm::vec2 point(0.003f * static_cast<float>(i), 0.3f);
            EXPECT_EQ(mesh::veil(mesh, triangle, point), mesh::veil(scene.mesh, triangle, point));
        }
    Sections bad = scenes::made(sections);
    bad["alphas"].pop_back();
    EXPECT_THROW(MaterialSections.read(scenes::reader_of("scene.prt", std::move(bad)), same),
                 std::runtime_error);
}

TEST(MaterialSections, KeepTexturesThatWereMadeInCode) {
    mesh::TriangleMesh mesh = scenes::textured_square();
    mesh.textures.push_back({.name = "grey", .width = 1, .height = 1, .texels = {{9, 9, 9}}});
    mesh.textures.push_back(
        {.name = "colours", .width = 2, .height = 1, .texels = {{9, 8, 7}, {1, 2, 3}}});
    for (const std::uint32_t texture : {1u, 2u})
        mesh.materials.push_back({.base_color_texture = mesh::TextureSlot{.texture = texture}});
    mesh.triangle_materials = {1, 2};
    const Sections good = written(mesh);
    const mesh::TriangleMesh same = read(good, mesh);
    expect_same_colors(same, mesh);
    ASSERT_EQ(same.textures.size(), 3u);
    for (std::size_t i = 1; i < 3; ++i)
        EXPECT_EQ(same.textures[i].texels, mesh.textures[i].texels);
    mesh.triangle_materials = {3, 3};
    mesh.materials[1].base_color_texture.reset();
    expect_same_colors(read(written(mesh), mesh), mesh);

    Sections bad = good;
    bad["alphas"].pop_back();
    EXPECT_THROW(static_cast<void>(read(bad, mesh)), std::runtime_error);
    bad["alphas"].resize(9);
    EXPECT_THROW(static_cast<void>(read(bad, mesh)), std::runtime_error);
}

TEST(MaterialSections, BrokenOnesAreRefused) {
    const mesh::TriangleMesh mesh = scenes::textured_square();
    const Sections good = written(mesh);
    const auto refused = [&](const auto& change) {
        Sections bad = good;
        change(bad);
        EXPECT_THROW(static_cast<void>(read(std::move(bad), mesh)), std::runtime_error);
    };
    for (const char* name : {"images", "t_materials"})
        refused([&](Sections& s) { s.erase(name); });
    refused([](Sections& s) { s["images"].pop_back(); });
    refused([](Sections& s) { s["images"].push_back(std::byte{0}); });
    refused([](Sections& s) { s["images"][2] = std::byte{99}; });
    refused([](Sections& s) { s["t_materials"][0] = std::byte{2}; });
    refused([](Sections& s) { s["t_materials"].pop_back(); });
    refused([](Sections& s) { s["corner_uvs"] = std::vector<std::byte>(8); });
    const auto replaced = [&](const std::string& from, const std::string& to) {
        refused([&](Sections& s) {
            const auto& bytes = s["materials"];
            std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
            ASSERT_NE(text.find(from), std::string::npos) << from;
            text.replace(text.find(from), from.size(), to);
            s["materials"] = bytes_of(std::vector<char>(text.begin(), text.end()));
        });
    };
    replaced("\"image\": 0", "\"image\": 1");
    replaced("\"image\": 0", "\"image\": -1");
    replaced("\"bytes\": 30", "\"bytes\": 4000000000");
    replaced("\"bytes\": 30", "\"bytes\": \"30\"");
    replaced("\"model\": 0", "\"model\": 4");
    replaced("\"metallic\": 0.0", "\"metallic\": 1.5");
    replaced("0.25", "1e30");
    replaced("\"srgb\": true", "\"srgb\": 1");
    replaced("{", "[");
}

} // namespace
} // namespace relumine::prt
