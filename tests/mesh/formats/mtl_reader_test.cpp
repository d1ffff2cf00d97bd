// Materials, groups and textures of OBJ files.

#include <fmt/format.h>

#include "mesh/floor.h"
#include "tests/mesh/mesh_files.h"
#include "tests/mesh/texture_files.h"

namespace relumine::mesh {
namespace {

using testing::ElementsAre;

class MtlTest : public MeshFileTest {
protected:
    [[nodiscard]] TriangleMesh with_mtl(const std::string& mtl,
                                        const std::string& statements = "") const {
        static_cast<void>(write("a.mtl", mtl));
        return load(write("mesh.obj", "mtllib a.mtl\n" + statements +
                                          "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n"));
    }
};

TEST_F(MtlTest, MaterialsAsWritten) {
    static_cast<void>(
        write("a.mtl", "# By hand\nnewmtl red wall\nKd 0.5 0.25 0.125\nKs 0 0 0\nNs 10\nillum 2\n\n"
                       "newmtl shiny\nKa 1 1 1\nKd 0.25\nKs 0.5 0.5 0.75\nNs 96.5\nd 0.5\n"
                       "newmtl metal\nKd 1 0.75 0.5\nPr 0.25\nPm 1\n"));
    const TriangleMesh mesh =
        load(write("mesh.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                               "usemtl shiny\nf 1 2 3 4\nusemtl red wall\nf 1 2 3\n"
                               "usemtl shiny\nf 2 3 4\nusemtl metal\nf 1 3 4\n"));
    ASSERT_EQ(mesh.materials.size(), 3u);
    EXPECT_EQ(
        mesh.materials[0],
        (Material{.name = "red wall", .base_color = {0.5f, 0.25f, 0.125f}, .exponent = 10.0f}));
    EXPECT_EQ(mesh.materials[1], (Material{.name = "shiny",
                                           .base_color = glm::vec3(0.25f),
                                           .specular = {0.5f, 0.5f, 0.75f},
                                           .exponent = 96.5f,
                                           .alpha_mode = AlphaMode::Blend,
                                           .alpha = 0.5f}));
    EXPECT_EQ(mesh.materials[2], (Material{.name = "metal",
                                           .model = MaterialModel::MetallicRoughness,
                                           .base_color = {1.0f, 0.75f, 0.5f},
                                           .metallic = 1.0f,
                                           .roughness = 0.25f}));
    EXPECT_THAT(mesh.triangle_materials, ElementsAre(1, 1, 0, 1, 2));
    EXPECT_THAT(mesh.missing, ElementsAre());
    EXPECT_TRUE(mesh.groups.empty());
    EXPECT_TRUE(mesh.triangle_groups.empty());
}

TEST_F(MtlTest, FacesWithoutAMaterialAndUnknownNames) {
    static_cast<void>(write("a.mtl", "newmtl known\nKd 0.5\n"));
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const TriangleMesh mesh = load(write(
        "mesh.obj",
        vertices +
            "f 1 2 3\nf 2 3 1\nusemtl known\nf 1 2 3\nusemtl other\nf 1 2 3\nmtllib a.mtl\n"));
    EXPECT_THAT(mesh.triangle_materials, ElementsAre(2, 2, 0, 1));
    EXPECT_EQ(mesh.materials[1], (Material{.name = "other"}));
    EXPECT_EQ(mesh.materials[2], (Material{.name = "default"}));
    EXPECT_THAT(mesh.missing, ElementsAre("material other"));

    const TriangleMesh alone =
        load(write("alone.obj", "mtllib gone.mtl\n" + vertices + "usemtl a\nf 1 2 3\n"));
    EXPECT_THAT(alone.missing, ElementsAre("gone.mtl"));
    EXPECT_EQ(alone.materials, (std::vector<Material>{{.name = "a"}}));
    EXPECT_TRUE(load(write("none.obj", vertices + "f 1 2 3\n")).materials.empty());
    EXPECT_TRUE(load(write("none.obj", vertices + "f 1 2 3\n")).triangle_materials.empty());
}

TEST_F(MtlTest, GroupsAndObjects) {
    const TriangleMesh mesh =
        obj("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\no body of it\nf 1 2 3 4\ng lid\nf 1 2 3\n"
            "o body of it\nf 2 3 4\ng\nf 1 2 3\n");
    EXPECT_THAT(mesh.groups, ElementsAre("body of it", "lid", "default"));
    EXPECT_THAT(mesh.triangle_groups, ElementsAre(2, 0, 0, 1, 0, 2));
}

/// A seam: vertices with several uvs. Concave polygons are cut elsewhere than fans, and keep each
/// corner's uv.
TEST_F(MtlTest, UvsPerCorner) {
    const TriangleMesh mesh = obj("v 0 0 0\nv 2 0 0\nv 0.5 0.5 0\nv 0 2 0\nv 5 0 0\n"
                                  "vt 0 0\nvt 2 0\nvt 0.5 0.5\nvt 0 2\nvt 9 9\n"
                                  "f 1/1 2/2 3/3 4/4\nf 2/5 5/1 3/3\nf 1 2 3\n");
    EXPECT_TRUE(mesh.uvs.empty());
    ASSERT_EQ(mesh.corner_uvs.size(), 4u);
    for (std::size_t t = 0; t < 2; ++t)
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_EQ(mesh.corner_uvs[t][i], glm::vec2(mesh.positions[mesh.triangles[t][i]]))
                << t << ' ' << i;
    EXPECT_EQ(mesh.corner_uvs[2][0], glm::vec2(9, 9));
    EXPECT_EQ(mesh.corner_uvs[3][0], glm::vec2(0, 0));
}

TEST_F(MtlTest, UvsThatAreNoNumbersAreLeftOutWithAWarning) {
    const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const TriangleMesh apart =
        obj(corners + "vt 0 0\nvt nan 0\nf 1/1 2/2 3/1\nf 1/2 2/1 3/1\nf 1/1 2/1 3/1\n");
    EXPECT_TRUE(apart.corner_uvs.empty());
    EXPECT_THAT(
        apart.warnings,
        testing::Contains(
            "2 of 3 triangles have texture coordinates that are no numbers: the set is left out"));
    const TriangleMesh shared = obj(corners + "vt 0 0\nvt 1 0\nvt 0 inf\nf 1/1 2/2 3/3\n");
    EXPECT_TRUE(shared.uvs.empty());
    EXPECT_THAT(
        shared.warnings,
        testing::Contains(
            "1 of 3 vertices have texture coordinates that are no numbers: the set is left out"));
    EXPECT_THAT(obj(corners + "vt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n").warnings,
                testing::IsEmpty());
}

TEST_F(MtlTest, TexturesWithTheirOptions) {
    std::filesystem::create_directory(folder_ / "maps");
    static_cast<void>(write("maps/a picture.png", four_colors()));
    const TriangleMesh mesh = with_mtl("newmtl m\nmap_Kd -s 2 3 1 -o 0.5 -clamp on -mm 0 1 maps\\a "
                                       "picture.png\nnewmtl n\nmap_Kd maps/a picture.png\n");
    ASSERT_EQ(mesh.textures.size(), 1u) << "one file, read once";
    EXPECT_EQ(mesh.textures[0].texels, (std::vector<Rgb8>{Blue, Gray, Red, Green}))
        << "v counts from the bottom";
    const TextureSlot& slot = *mesh.materials[0].base_color_texture;
    EXPECT_EQ(slot, (TextureSlot{.is_srgb = true,
                                 .wrap = {Wrap::Clamp, Wrap::Clamp},
                                 .uv_from_mesh_uv = glm::mat2(2, 0, 0, 3),
                                 .uv_offset = {0.5f, 0.0f}}));
    EXPECT_EQ(*mesh.materials[1].base_color_texture, (TextureSlot{.is_srgb = true}));
    EXPECT_EQ(sample(mesh.textures[0], *mesh.materials[1].base_color_texture, {0.25f, 0.75f}),
              glm::vec3(1, 0, 0));

    const TriangleMesh without = with_mtl("newmtl m\nmap_Kd gone.png\n");
    EXPECT_THAT(without.missing, ElementsAre("gone.png"));
    EXPECT_FALSE(without.materials[0].base_color_texture);
}

TEST_F(MtlTest, TheFloorHasItsOwn) {
    TriangleMesh mesh =
        with_mtl("newmtl m\nKd 0.5\n", "o thing\nvt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/2 2/2 3/2\n");
    append_floor(mesh, 3);
    EXPECT_EQ(mesh.materials.back(), (Material{.name = "floor"}));
    EXPECT_THAT(mesh.groups, ElementsAre("thing", "floor"));
    ASSERT_EQ(mesh.num_triangles(), 3u + 8u);
    EXPECT_EQ(mesh.triangle_materials.size(), mesh.num_triangles());
    EXPECT_EQ(mesh.triangle_materials.back(), mesh.materials.size() - 1);
    EXPECT_EQ(mesh.triangle_groups.size(), mesh.num_triangles());
    EXPECT_EQ(mesh.triangle_groups[2], 0u);
    EXPECT_EQ(mesh.triangle_groups[3], 1u);
    EXPECT_EQ(mesh.corner_uvs.size(), mesh.num_triangles());

    TriangleMesh plain = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    append_floor(plain, 2);
    EXPECT_TRUE(plain.materials.empty());
    EXPECT_THAT(plain.groups, ElementsAre("mesh", "floor"));
    EXPECT_THAT(plain.triangle_groups, ElementsAre(0, 1, 1));
}

/// Neither a material nor an image ends the load: the surface is grey, or without its texture.
TEST_F(MtlTest, WhatCannotBeReadCostsItselfAndAWarning) {
    const auto warns = [&](const std::string& mtl, const std::string& part) {
        const TriangleMesh mesh =
            with_mtl("newmtl m\nNs 5\n" + mtl + "Kd 0.25\nnewmtl n\nKd 0.5\n", "usemtl n\n");
        EXPECT_THAT(mesh.warnings, ElementsAre(testing::HasSubstr(part))) << mtl;
        for (const Material& material : mesh.materials)
            EXPECT_EQ(material.base_color, glm::vec3(material.name == "m" ? 0.25f : 0.5f)) << mtl;
    };
    warns("Kd 1 1\n", "Kd of the material m is left out: a.mtl: expected 1 or 3 numbers of Kd in "
                      "line 3, got 2");
    warns("Ks 1 x 1\n", "a number in line 3, got 'x'");
    warns("Kd spectral file.rfl\n", "line 3");
    warns("Ks nan\n", "a finite number in line 3, got 'nan'");
    warns("Ns\n", "1 number of Ns");
    warns("map_Kd\n", "file name of a texture");
    warns("map_Kd -o\n", "arguments of -o");
    warns("Ks 1 1 1.5\n", "the material m: expected 0 to 1 as \"Ks\", got 1.5: it counts as 1");
    warns("Ks 2 3 4\n", "as \"Ks\", got 2: it counts as 1");
    warns("Ns -1\n", "as \"Ns\", got -1: it counts as 0");
    warns("Pr 2\n", "as \"Pr\", got 2: it counts as 1");
    warns("d -halo 0.5\n", "the materials have d -halo, which is not read");
    EXPECT_EQ(with_mtl("newmtl m\nd -halo 0.5\n").materials[0].alpha, 0.5f);
    EXPECT_THAT(with_mtl(std::string("newmtl m\0\n", 10)).warnings,
                ElementsAre(testing::HasSubstr("a.mtl cannot be read, its materials are grey: ")));

    static_cast<void>(write("broken.png", four_colors().substr(0, 40)));
    const TriangleMesh mesh = with_mtl("newmtl m\nKd 0.25\nmap_Kd broken.png\n"
                                       "newmtl n\nmap_Kd broken.png\n");
    EXPECT_THAT(mesh.warnings,
                ElementsAre(testing::StartsWith("the image broken.png is left out: expected")));
    EXPECT_EQ(mesh.materials[0], (Material{.name = "m", .base_color = glm::vec3(0.25f)}));
    EXPECT_TRUE(mesh.textures.empty());
}

TEST_F(MtlTest, TransparencyThatMeansOpacity) {
    const auto alpha = [&](const std::string& mtl) {
        return with_mtl("newmtl m\nKd 0.5\n" + mtl).materials[0].alpha;
    };
    EXPECT_EQ(alpha("Tr 0.25\n"), 0.75f);
    EXPECT_EQ(alpha("Tr 0\n"), 1.0f);
    EXPECT_EQ(alpha("d 1\nTr 1\n"), 1.0f) << "d counts";
    EXPECT_EQ(alpha("Tr 1\nd 1\n"), 1.0f);
    EXPECT_EQ(alpha("Tr 0\nd 0.5\n"), 0.5f);
    const TriangleMesh one = with_mtl("newmtl m\nTr 1.000000\nnewmtl n\nTr 0.75\n", "usemtl n\n");
    for (const Material& material : one.materials)
        EXPECT_EQ(material.alpha, material.name == "m" ? 1.0f : 0.75f);
    EXPECT_THAT(one.notes, ElementsAre("Tr 1 is taken as opaque: as transparency it would be "
                                       "invisible"));
    // A library that has both says that 1 is invisible.
    const TriangleMesh both = with_mtl("newmtl m\nTr 1\nnewmtl n\nTr 0\n", "usemtl n\n");
    EXPECT_THAT(both.warnings, ElementsAre("a material is invisible, since d is 0 or Tr 1: m"));
    EXPECT_THAT(with_mtl("newmtl m\nd 0\n").warnings,
                ElementsAre("a material is invisible, since d is 0 or Tr 1: m"));
}

TEST_F(MtlTest, AsTheProgramsMeanThatWroteThem) {
    const TriangleMesh meshlab =
        with_mtl("#\n# Wavefront material file\n# Converted by Meshlab Group\n#\n\nnewmtl m\n"
                 "Ka 0.2 0.2 0.2\nKd 1 1 1\nKs 1 1 1\nTr 1.000000\nillum 2\nNs 0.000000\n");
    EXPECT_EQ(meshlab.materials[0], (Material{.name = "m"}));
    EXPECT_THAT(meshlab.notes, ElementsAre("Tr 1 is opaque, as MeshLab writes it",
                                           "Ks is left out: MeshLab writes it whatever it shows"));
    const std::string principled = "newmtl m\nNs 250\nKa 1 1 1\nKd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\n"
                                   "Ke 0 0 0\nNi 1.45\nd 1\nillum 2\n";
    Material plastic{.name = "m",
                     .model = MaterialModel::MetallicRoughness,
                     .base_color = glm::vec3(0.8f),
                     .roughness = 0.5f};
    const TriangleMesh blender =
        with_mtl("# Blender 3.4.1 MTL File: 'None'\n# www.blender.org\n\n" + principled);
    EXPECT_EQ(blender.materials[0], plastic);
    EXPECT_THAT(blender.notes, ElementsAre("Ks and Ns are read as Specular and roughness, as "
                                           "Blender writes them"));
    const TriangleMesh old = with_mtl("# Blender MTL File: 'a.blend'\n# Material Count: 1\n" +
                                      replace_all(principled, "Ns 250", "Ns 225"));
    EXPECT_EQ(old.materials[0], plastic);
    plastic.metallic = 0.25f;
    EXPECT_EQ(with_mtl("# Blender 4.0.2 MTL File: 'a.blend'\n" +
                       replace_all(replace_all(principled, "illum 2", "illum 3"), "Ka 1 1 1",
                                   "Ka 0.25 0.25 0.25"))
                  .materials[0],
              plastic);
    EXPECT_EQ(with_mtl(principled).materials[0].specular, glm::vec3(0.5f)) << "of others";
}

TEST_F(MtlTest, FilesOfOtherCapitalsAndOtherComputers) {
    std::filesystem::create_directories(folder_ / "Textures");
    static_cast<void>(write("Textures/Wood.PNG", four_colors()));
    static_cast<void>(write("Scene.MTL", "newmtl m\nmap_Kd textures\\wood.png\n"
                                         "newmtl n\nmap_Kd C:\\Users\\me\\Textures\\wood.png\n"
                                         "newmtl o\nmap_Kd /home/me/../you/WOOD.png\n"
                                         "newmtl p\nmap_Kd /home/me/plaster.png\n"));
    const TriangleMesh mesh = load(write("mesh.obj", "mtllib scene.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                                                     "usemtl m\nf 1 2 3\nusemtl n\nf 1 2 3\n"));
    EXPECT_TRUE(mesh.materials[0].base_color_texture);
    EXPECT_TRUE(mesh.materials[1].base_color_texture);
    EXPECT_EQ(mesh.textures.size(), 1u);
    EXPECT_THAT(mesh.missing, ElementsAre("/home/me/../you/WOOD.png", "/home/me/plaster.png"));
    EXPECT_THAT(mesh.notes,
                ElementsAre("scene.mtl is read from Scene.MTL",
                            "textures\\wood.png is read from Textures/Wood.PNG",
                            "C:\\Users\\me\\Textures\\wood.png is read from Textures/Wood.PNG"));
    // By the name alone, beside the mesh.
    std::filesystem::rename(folder_ / "Textures/Wood.PNG", folder_ / "wood.png");
    EXPECT_THAT(load(folder_ / "mesh.obj").missing, ElementsAre("/home/me/plaster.png"));
}

TEST_F(MtlTest, SeveralLibrariesWithBlanksInTheirNames) {
    for (const char* color : {"red", "green", "blue"})
        static_cast<void>(write(fmt::format("box {}.mtl", color),
                                fmt::format("newmtl {}\nKd 0.5 0.5 0.5\n", color)));
    const TriangleMesh mesh =
        load(write("mesh.obj", "mtllib box red.mtl\nmtllib box green.mtl box blue.mtl gone 1\n"
                               "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n"
                               "usemtl green\nf 1 2 3\nusemtl blue\nf 1 2 3\n"));
    for (const Material& material : mesh.materials)
        EXPECT_EQ(material.base_color, glm::vec3(0.5f)) << material.name;
    EXPECT_THAT(mesh.missing, ElementsAre("gone 1"));
}

TEST_F(MtlTest, RoundingsAboveOneAreOne) {
    const TriangleMesh mesh = with_mtl("newmtl m\nKd 1.00000012 1.0001 -0.00001\n");
    EXPECT_EQ(mesh.materials[0], (Material{.name = "m", .base_color = {1, 1, 0}}));
    EXPECT_THAT(mesh.warnings, ElementsAre());
}

/// `norm` has normals; `bump` has them where they are vectors of length 1, otherwise heights.
TEST_F(MtlTest, NormalMaps) {
    static_cast<void>(write("normals.png", png(2, 1, {{128, 128, 255}, {218, 128, 218}})));
    static_cast<void>(write("heights.png", png(2, 1, {{128, 128, 128}, {255, 255, 255}})));
    for (const char* statement : {"norm -bm 0.5", "map_Bump -bm 0.5", "bump -bm 0.5"}) {
        const TriangleMesh mesh =
            with_mtl(std::string("newmtl m\n") + statement + " normals.png\n");
        ASSERT_TRUE(mesh.materials[0].normal_texture) << statement;
        EXPECT_FALSE(mesh.materials[0].normal_texture->is_srgb);
        EXPECT_EQ(mesh.materials[0].normal_scale, 0.5f);
        EXPECT_EQ(mesh.corner_tangents.size(), 1u);
        EXPECT_THAT(mesh.warnings, ElementsAre());
    }
    const TriangleMesh heights =
        with_mtl("newmtl m\nbump heights.png\nmap_Kd heights.png\nnewmtl n\nbump heights.png\n");
    EXPECT_FALSE(heights.materials[0].normal_texture);
    EXPECT_EQ(heights.textures.size(), 1u) << "that of the colours";
    EXPECT_TRUE(heights.corner_tangents.empty());
    EXPECT_THAT(heights.warnings, ElementsAre("the materials have bump, which is not read"));
    EXPECT_THAT(with_mtl("newmtl m\nnorm gone.png\n").missing, ElementsAre("gone.png"));
}

TEST_F(MtlTest, SaysWhatIsNotRead) {
    EXPECT_THAT(with_mtl("newmtl m\nKa 1 1 1\nKe 0 0 0\nd 1.000\nTr 0.0\nillum 2\nTf 1 1 1\n"
                         "aniso 0\n")
                    .warnings,
                ElementsAre());
    static_cast<void>(write("a.png", four_colors()));
    EXPECT_THAT(
        with_mtl("newmtl m\nmap_Ns a.png\nmap_Bump a.png\nTf 1 0 0\nnewmtl n\nPr 0.5\n"
                 "map_Ks a.png\naniso 0.5\nmap_Ns a.png\n")
            .warnings,
        ElementsAre(
            "the materials have map_Ns, map_Bump, Tf, aniso, map_Ks of materials with a roughness, "
            "which are not read"));
}

TEST_F(MtlTest, EmissionAndItsMap) {
    static_cast<void>(write("a.png", four_colors()));
    const TriangleMesh mesh = with_mtl("newmtl m\nKe 2 0.5 0\nmap_Ke a.png\n"
                                       "newmtl n\nKe 0 0 0\nmap_Ke a.png\nnewmtl o\nKe 3\n");
    EXPECT_EQ(mesh.materials[0].emission, glm::vec3(2.0f, 0.5f, 0.0f));
    EXPECT_TRUE(mesh.materials[0].emission_texture->is_srgb);
    EXPECT_EQ(mesh.materials[1].emission, glm::vec3(1.0f)) << "the map alone";
    EXPECT_EQ(mesh.materials[2].emission, glm::vec3(3.0f));
    EXPECT_THAT(mesh.warnings, ElementsAre());
}

TEST_F(MtlTest, AlphaBlendsOrCutsOut) {
    static_cast<void>(write("leaf.png", png(2, 1, {{0, 0, 0}, {255, 255, 255}})));
    static_cast<void>(write("smoke.png", png(2, 1, {{40, 40, 40}, {200, 200, 200}})));
    const TriangleMesh mesh =
        with_mtl("newmtl a\nd 0.25\nnewmtl b\nTr 0.25\nnewmtl c\nmap_d leaf.png\n"
                 "newmtl d\nd 0.5\nmap_d smoke.png\nnewmtl e\nd 1\nTr 0\n");
    EXPECT_EQ(mesh.materials[0].alpha_mode, AlphaMode::Blend);
    EXPECT_EQ(mesh.materials[0].alpha, 0.25f);
    EXPECT_EQ(mesh.materials[1].alpha, 0.75f);
    EXPECT_EQ(mesh.materials[2].alpha_mode, AlphaMode::Mask);
    EXPECT_FALSE(mesh.materials[2].alpha_texture->is_srgb);
    EXPECT_EQ(mesh.materials[3].alpha_mode, AlphaMode::Blend);
    EXPECT_EQ(mesh.textures[mesh.materials[3].alpha_texture->texture].texels[0],
              (Rgb8{40, 40, 40}));
    EXPECT_EQ(mesh.materials[4], (Material{.name = "e"}));
    EXPECT_EQ(mesh.textures.size(), 2u);
}

/// An image with alpha is meant by its alpha, whatever its colours are.
TEST_F(MtlTest, AlphaOfAnImageOfColours) {
    static_cast<void>(write("leaf.png", png_of_alpha(2, 1, {{255, 0, 0, 255}, {255, 0, 0, 100}})));
    const TriangleMesh mesh = with_mtl("newmtl m\nmap_Kd leaf.png\nmap_d leaf.png\n");
    const Material& leaf = mesh.materials[0];
    ASSERT_EQ(mesh.textures.size(), 2u);
    EXPECT_EQ(mesh.textures[leaf.base_color_texture->texture].texels[1], Red);
    EXPECT_EQ(mesh.textures[leaf.alpha_texture->texture].texels[1], (Rgb8{100, 100, 100}));
    EXPECT_EQ(leaf.alpha_mode, AlphaMode::Blend);
}

TEST_F(MtlTest, PhysicallyBasedExtension) {
    static_cast<void>(write("r.png", png(1, 1, {{64, 64, 64}})));
    static_cast<void>(write("m.png", png(1, 1, {{128, 128, 128}})));
    const TriangleMesh mesh =
        with_mtl("newmtl m\nKd 0.5\nPr 0.5\nPm 0\nPc 0.75\nPcr 0.125\nPs 0.25\n"
                 "map_Pr r.png\nmap_Pm m.png\n");
    const Material& m = mesh.materials[0];
    EXPECT_EQ(m.model, MaterialModel::MetallicRoughness);
    EXPECT_EQ(m.roughness, 0.5f);
    EXPECT_EQ(m.metallic, 1.0f) << "the map alone";
    EXPECT_EQ(m.coat, 0.75f);
    EXPECT_EQ(m.coat_roughness, 0.125f);
    EXPECT_EQ(m.sheen, glm::vec3(0.25f));
    EXPECT_EQ(mesh.textures[m.roughness_texture->texture].texels[0], (Rgb8{64, 64, 64}));
    EXPECT_EQ(mesh.textures[m.metallic_texture->texture].texels[0], (Rgb8{128, 128, 128}));
    EXPECT_FALSE(m.roughness_texture->is_srgb);
    EXPECT_THAT(mesh.warnings, ElementsAre());
}

/// Every slot takes images of 1 pixel and of 16 bits, and goes without what cannot be read.
TEST_F(MtlTest, ImagesOfAllSlots) {
    static_cast<void>(write("one.png", png(1, 1, {Gray})));
    static_cast<void>(write("deep.png", png_of_16_bits(0x8080)));
    std::string huge = four_colors();
    huge[16] = 0, huge[17] = 1; // 65538 pixels wide
    static_cast<void>(write("huge.png", huge));
    for (const std::string statement :
         {"map_Kd", "map_Ks", "map_Ke", "map_d", "map_Pr", "map_Pm", "norm"}) {
        for (const std::string image : {"one.png", "deep.png"}) {
            const TriangleMesh mesh = with_mtl("newmtl m\n" + statement + " " + image + "\n");
            ASSERT_EQ(mesh.textures.size(), 1u) << statement << image;
            EXPECT_EQ(mesh.textures[0].texels, (std::vector<Rgb8>{Gray})) << statement << image;
            EXPECT_THAT(mesh.warnings, ElementsAre()) << statement << image;
        }
        const TriangleMesh without = with_mtl("newmtl m\n" + statement + " gone.png\n");
        EXPECT_THAT(without.missing, ElementsAre("gone.png")) << statement;
        const TriangleMesh refused = with_mtl("newmtl m\n" + statement + " huge.png\n");
        EXPECT_THAT(refused.warnings,
                    ElementsAre(testing::AllOf(
                        testing::StartsWith("the image huge.png is left out: expected"),
                        testing::HasSubstr("at most 16384 x 16384 pixels"))))
            << statement;
        EXPECT_TRUE(refused.textures.empty()) << statement;
    }
}

} // namespace
} // namespace relumine::mesh
