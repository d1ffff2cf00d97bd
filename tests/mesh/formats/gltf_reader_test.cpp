// glTF and GLB: geometry, transforms, materials and textures as written; broken files.
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/trigonometric.hpp>

#include "mesh/edge_uses.h"
#include "mesh/opacity.h"
#include "mesh/save.h"
#include "tests/mesh/encoders.h"
#include "tests/mesh/gltf_model.h"
#include "tests/mesh/texture_files.h"

namespace relumine::mesh {
namespace {

using testing::ElementsAre;

using GltfTest = MeshFileTest;

TEST_F(GltfTest, TheSameEmbeddedExternalAndBinary) {
    const Model model = square();
    static_cast<void>(write("some data.bin", model.buffer + "padding"));
    const TriangleMesh embedded = load(write("a.gltf", model.embedded()));
    EXPECT_EQ(defect(embedded), "");
    EXPECT_EQ(embedded.positions,
              (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
    EXPECT_EQ(embedded.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_EQ(embedded.uvs, (std::vector<glm::vec2>{{0, 1}, {1, 1}, {1, 0}, {0, 0}}));
    EXPECT_EQ(embedded.normals, std::vector<glm::vec3>(4, {0, 0, 1})) << "the file has none";
    EXPECT_THAT(embedded.groups, ElementsAre("square"));
    EXPECT_THAT(embedded.triangle_groups, ElementsAre(0, 0));
    // The format's default material.
    EXPECT_EQ(embedded.materials, (std::vector<Material>{{.name = "default",
                                                          .model = MaterialModel::MetallicRoughness,
                                                          .metallic = 1.0f,
                                                          .times_vertex_color = true,
                                                          .is_double_sided = false}}));
    for (const auto& path :
         {write("b.gltf", model.external("some%20data.bin")), write("c.GLB", model.glb())}) {
        const TriangleMesh other = load(path);
        EXPECT_EQ(other.positions, embedded.positions);
        EXPECT_EQ(other.triangles, embedded.triangles);
        EXPECT_EQ(other.uvs, embedded.uvs);
    }
}

TEST_F(GltfTest, OurOwnFilesLoadAgain) {
    const TriangleMesh box = ply(box_ply());
    const std::vector<glm::vec3> radiance(8, glm::vec3(100.0f, 0.5f, 0.0f));
    save_lit(folder_ / "box.glb", box, radiance);
    const TriangleMesh loaded = load(folder_ / "box.glb");
    expect_box(loaded);
    EXPECT_EQ(loaded.colors, radiance);
    EXPECT_EQ(loaded.materials,
              (std::vector<Material>{
                  {.name = "lit", .model = MaterialModel::Unlit, .times_vertex_color = true}}));
}

TEST_F(GltfTest, FilesOfOtherCapitals) {
    const Model model = square();
    static_cast<void>(write("Data.BIN", model.buffer));
    const TriangleMesh mesh = load(write("a.gltf", model.external("data.bin")));
    EXPECT_EQ(mesh.num_triangles(), 2u);
    EXPECT_THAT(mesh.warnings, ElementsAre("data.bin is read from Data.BIN"));
    EXPECT_THAT(load(write("b.gltf", model.external("Data.BIN"))).warnings, ElementsAre());
}

TEST_F(GltfTest, FacesWithoutNormalsAreFlat) {
    // A tent of two squares that share an edge; the file has no normals [glTF 2.0, 3.7.2.1].
    Model model = square();
    const auto positions = model.add<glm::vec3>(
        {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, -1}, {2, 1, -1}}, 5126, "VEC3");
    const auto indices =
        model.add<std::uint16_t>({0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2}, 5123, "SCALAR");
    model.json["meshes"][0]["primitives"] = {
        {{"attributes", {{"POSITION", positions}}}, {"indices", indices}}};
    const TriangleMesh mesh = gltf(model.embedded());
    EXPECT_EQ(defect(mesh), "");
    ASSERT_EQ(mesh.num_vertices(), 8u) << "two on the edge are repeated";
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t vertex : t)
            EXPECT_NEAR(glm::distance(glm::dvec3(mesh.normals[vertex]),
                                      glm::normalize(area_normal(mesh.positions, t))),
                        0.0, 1e-6);
    EXPECT_THAT(mesh.notes,
                ElementsAre("4 faces without normals are flat; --crease 180 rounds them",
                            "2 vertices are added behind the 6 of the file, where normals or "
                            "colours of faces differ"));
    EXPECT_EQ(gltf(model.embedded(), NormalSource::Smooth).num_vertices(), 6u);
    EXPECT_TRUE(gltf(model.embedded(), NormalSource::Smooth).notes.empty());
    // Beside a primitive with normals, which keeps them.
    const auto normals =
        model.add<glm::vec3>(std::vector<glm::vec3>(6, {0, 0.6f, 0.8f}), 5126, "VEC3");
    model.json["meshes"][0]["primitives"].push_back(
        {{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}, {"indices", indices}});
    const TriangleMesh both = gltf(model.embedded());
    ASSERT_EQ(both.num_vertices(), 14u);
    EXPECT_EQ(both.normals[6], glm::vec3(0, 0.6f, 0.8f));
}

TEST_F(GltfTest, NodesPlaceMeshes) {
    Model model = square();
    const auto normals =
        model.add<glm::vec3>(std::vector<glm::vec3>(4, {0, 0.6f, 0.8f}), 5126, "VEC3");
    model.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normals;
    const double h = std::sqrt(0.5);
    model.json["nodes"] = {
        {{"name", "root"}, {"translation", {10, 0, 0}}, {"children", {1, 2, 3}}},
        {{"name", "turned"}, {"mesh", 0}, {"rotation", {0, h, 0, h}}}, // 90 degrees about +Y
        {{"name", "scaled"}, {"mesh", 0}, {"scale", {1, 2, 1}}, {"translation", {0, 0, 5}}},
        {{"mesh", 0}, {"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 7, 0, 1}}}};
    const TriangleMesh mesh = gltf(model.embedded());
    EXPECT_EQ(defect(mesh), "");
    ASSERT_EQ(mesh.num_vertices(), 12u);
    EXPECT_THAT(mesh.groups, ElementsAre("turned", "scaled", "square"));
    EXPECT_THAT(mesh.triangle_groups, ElementsAre(0, 0, 1, 1, 2, 2));
    const auto near = [](const glm::vec3& a, const glm::vec3& b) {
        return glm::distance(a, b) < 1e-6f;
    };
    EXPECT_TRUE(near(mesh.positions[2], {10, 1, -1})) << "+X goes to -Z";
    EXPECT_TRUE(near(mesh.normals[2], {0.8f, 0.6f, 0}));
    EXPECT_TRUE(near(mesh.positions[6], {11, 2, 5}));
    EXPECT_TRUE(near(mesh.normals[6], glm::normalize(glm::vec3(0, 0.3f, 0.8f))))
        << "by the inverse's transpose";
    EXPECT_TRUE(near(mesh.positions[10], {9, 8, 0}));
    EXPECT_TRUE(near(mesh.normals[10], {0, 0.6f, 0.8f})) << "mirrored: still outside";
    EXPECT_EQ(mesh.triangles[4], (Triangle{8, 10, 9})) << "mirrored: turned back";
}

TEST_F(GltfTest, StripsFansPointsAndPrimitivesWithoutIndices) {
    Model model = square();
    Json& primitives = model.json["meshes"][0]["primitives"];
    const auto strip = model.add<std::uint8_t>({0, 1, 3, 2}, 5121, "SCALAR");
    const auto fan = model.add<std::uint32_t>({0, 1, 2, 3}, 5125, "SCALAR");
    Json primitive = primitives[0];
    primitives[0]["mode"] = 5, primitives[0]["indices"] = strip;
    primitive["mode"] = 6, primitive["indices"] = fan;
    primitives.push_back(primitive);
    primitive["mode"] = 0;
    primitives.push_back(primitive);
    primitive["mode"] = 5;
    primitive.erase("indices");
    primitives.push_back(primitive);
    const TriangleMesh mesh = gltf(model.embedded(), NormalSource::Smooth);
    EXPECT_EQ(mesh.num_vertices(), 12u);
    EXPECT_EQ(mesh.triangles,
              (std::vector<Triangle>{
                  {0, 1, 3}, {1, 2, 3}, {5, 6, 4}, {6, 7, 4}, {8, 9, 10}, {9, 11, 10}}));
}

TEST_F(GltfTest, QuantizedAttributesAndColors) {
    Model model = square();
    Json& attributes = model.json["meshes"][0]["primitives"][0]["attributes"];
    using Color = std::array<std::uint8_t, 4>;
    attributes["COLOR_0"] = model.add<Color>(
        {{255, 0, 51, 255}, {0, 0, 0, 9}, {0, 255, 0, 0}, {1, 2, 3, 4}}, 5121, "VEC4", true);
    using Uv = std::array<std::uint16_t, 2>;
    attributes["TEXCOORD_0"] =
        model.add<Uv>({{0, 65535}, {65535, 0}, {0, 0}, {0, 0}}, 5123, "VEC2", true);
    using Position = std::array<std::int16_t, 4>; // padded to four bytes
    const auto positions = model.add<Position>(
        {{-5, 0, 0, 0}, {1, 0, 0, 0}, {1, 1, 0, 0}, {0, 300, 0, 0}}, 5122, "VEC3");
    model.json["bufferViews"].back()["byteStride"] = 8;
    attributes["POSITION"] = positions;
    model.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    const TriangleMesh mesh = gltf(model.embedded());
    EXPECT_EQ(mesh.colors[0], glm::vec3(1.0f, 0.0f, 0.2f));
    EXPECT_EQ(mesh.uvs[0], glm::vec2(0, 1));
    EXPECT_EQ(mesh.positions[0], glm::vec3(-5, 0, 0));
    EXPECT_EQ(mesh.positions[3], glm::vec3(0, 300, 0));
    EXPECT_THAT(mesh.warnings, ElementsAre());
    // Without the mark they are parts of 255, too.
    model.json["accessors"][attributes["COLOR_0"].get<std::size_t>()]["normalized"] = false;
    const TriangleMesh unmarked = gltf(model.embedded());
    EXPECT_EQ(unmarked.colors, mesh.colors);
    EXPECT_THAT(unmarked.warnings, ElementsAre("COLOR_0 has whole numbers that are not marked as "
                                               "normalized: 255 counts as 1"));
}

TEST_F(GltfTest, MaterialsAsWritten) {
    Model model = square();
    model.json["materials"] = {
        {{"name", "gold"},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", {1.0, 0.75, 0.25, 0.5}}, {"roughnessFactor", 0.25}}}},
        {{"pbrMetallicRoughness", {{"metallicFactor", 0.5}}}}};
    model.json["meshes"][0]["primitives"][0]["material"] = 1;
    const TriangleMesh mesh = gltf(model.embedded());
    EXPECT_EQ(mesh.materials[0], (Material{.name = "gold",
                                           .model = MaterialModel::MetallicRoughness,
                                           .base_color = {1.0f, 0.75f, 0.25f},
                                           .metallic = 1.0f,
                                           .roughness = 0.25f,
                                           .times_vertex_color = true,
                                           .is_double_sided = false}));
    EXPECT_EQ(mesh.materials[1].name, "material 1");
    EXPECT_EQ(mesh.materials[1].metallic, 0.5f);
    EXPECT_EQ(mesh.materials[1].roughness, 1.0f);
    EXPECT_THAT(mesh.triangle_materials, ElementsAre(1, 1));
}

/// v counts from the top: (0.25, 0.25) is the upper left of the picture, red.
TEST_F(GltfTest, TexturesEmbeddedAndExternal) {
    Model model = square();
    static_cast<void>(write("four.png", four_colors()));
    const auto view = model.add_view(four_colors());
    model.json["images"] = {{{"uri", "four.png"}},
                            {{"uri", "data:image/png;base64," + base64(four_colors())}},
                            {{"bufferView", view}, {"mimeType", "image/png"}, {"name", "inside"}},
                            {{"uri", "unused.png"}}};
    model.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}}};
    model.json["textures"] = {{{"source", 0}}, {{"source", 1}, {"sampler", 0}}, {{"source", 2}}};
    for (int i = 0; i < 3; ++i)
        model.json["materials"].push_back({{"pbrMetallicRoughness",
                                            {{"baseColorTexture", {{"index", i}}},
                                             {"metallicRoughnessTexture", {{"index", 2 - i}}}}}});
    model.json["meshes"][0]["primitives"][0]["material"] = 0;
    for (const TriangleMesh& mesh :
         {load(write("a.gltf", model.embedded())), load(write("b.glb", model.glb()))}) {
        ASSERT_EQ(mesh.textures.size(), 3u) << "each once, the unused one not at all";
        EXPECT_EQ(mesh.textures[0].name, "four.png");
        EXPECT_EQ(mesh.textures[1].name, "inside");
        EXPECT_THAT(mesh.missing, ElementsAre());
        for (const Material& material : mesh.materials) {
            EXPECT_TRUE(material.base_color_texture->is_srgb);
            EXPECT_FALSE(material.metallic_roughness_texture->is_srgb);
            const Texture& texture = mesh.textures[material.base_color_texture->texture];
            EXPECT_EQ(sample(texture, *material.base_color_texture, {0.25f, 0.25f}),
                      glm::vec3(1, 0, 0));
            EXPECT_NEAR(sample(texture, *material.base_color_texture, {0.75f, 0.75f}).r,
                        std::pow((128.0 / 255.0 + 0.055) / 1.055, 2.4), 1e-6);
            EXPECT_NEAR(sample(texture, *material.metallic_roughness_texture, {0.75f, 0.75f}).r,
                        128.0 / 255.0, 1e-6);
        }
        EXPECT_EQ(mesh.materials[1].base_color_texture->wrap,
                  (std::array<Wrap, 2>{Wrap::Clamp, Wrap::Mirror}));
        EXPECT_EQ(mesh.materials[0].base_color_texture->wrap,
                  (std::array<Wrap, 2>{Wrap::Repeat, Wrap::Repeat}));
    }
    std::filesystem::remove(folder_ / "four.png");
    const TriangleMesh mesh = load(folder_ / "a.gltf");
    EXPECT_THAT(mesh.missing, ElementsAre("four.png"));
    EXPECT_FALSE(mesh.materials[0].base_color_texture);
}

/// KHR_texture_transform's own example: half of each side, turned by 90 degrees, from (0, 1) on.
TEST_F(GltfTest, TextureTransformAndOtherUvSets) {
    Model model = square();
    Json& primitive = model.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["TEXCOORD_3"] =
        model.add<glm::vec2>(std::vector<glm::vec2>(4, {0.75f, 0.5f}), 5126, "VEC2");
    primitive["material"] = 0;
    model.json["images"] = {{{"uri", "data:image/png;base64," + base64(four_colors())}}};
    model.json["textures"] = {{{"source", 0}}};
    const Json transform = {{"offset", {0, 1}},
                            {"rotation", std::numbers::pi / 2},
                            {"scale", {0.5, 0.5}},
                            {"texCoord", 3}};
    Json info = {{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}};
    model.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", info}}}}};
    const TriangleMesh mesh = gltf(model.embedded());
    EXPECT_EQ(mesh.uvs, std::vector<glm::vec2>(4, {0.75f, 0.5f}));
    const TextureSlot& slot = *mesh.materials[0].base_color_texture;
    // The published matrices: translation * rotation (cos, sin; -sin, cos by rows) * scale.
    for (const glm::vec2& uv : {glm::vec2(0.25f, 0.5f), glm::vec2(1.0f, 0.0f)}) {
        const glm::vec2 placed = slot.uv_from_mesh_uv * uv + slot.uv_offset;
        EXPECT_NEAR(placed.x, 0.5f * uv.y, 1e-6f);
        EXPECT_NEAR(placed.y, 1.0f - 0.5f * uv.x, 1e-6f);
    }
    model.json["materials"][0]["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {{"index", 0}};
    model.json["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"] = 0.5;
    const TriangleMesh mixed = gltf(model.embedded());
    EXPECT_EQ(mixed.uvs, mesh.uvs) << "the colours' set";
    EXPECT_EQ(mixed.second_uvs[2], glm::vec2(1.0f, 0.0f));
    EXPECT_EQ(mixed.materials[0].base_color_texture, mesh.materials[0].base_color_texture);
    EXPECT_EQ(mixed.materials[0].base_color_texture->uv_set, 0u);
    EXPECT_EQ(mixed.materials[0].metallic_roughness_texture->uv_set, 1u);
    EXPECT_THAT(mixed.warnings, ElementsAre());
    model.json["materials"][0]["normalTexture"] = {{"index", 0}, {"texCoord", 1}};
    const TriangleMesh three = gltf(model.embedded());
    EXPECT_FALSE(three.materials[0].normal_texture);
    EXPECT_THAT(three.warnings,
                ElementsAre("the material material 0 has textures in TEXCOORD_3, TEXCOORD_0 and "
                            "TEXCOORD_1; two sets are read: its normal_texture is left out"));
}

TEST_F(GltfTest, SpecularCoatAndSheen) {
    Model model = square();
    const std::string image = webp(2, 1, {{255, 128, 0, 255}, {0, 0, 0, 51}});
    static_cast<void>(write("a.webp", image));
    model.json["images"] = {{{"uri", "a.webp"}}};
    model.json["textures"] = {{{"source", 0}}};
    const Json texture = {{"index", 0}};
    const Json extensions = {{"KHR_materials_ior", {{"ior", 1.25}}},
                             {"KHR_materials_specular",
                              {{"specularFactor", 0.5},
                               {"specularTexture", texture},
                               {"specularColorFactor", {2, 1, 0.5}},
                               {"specularColorTexture", texture}}},
                             {"KHR_materials_clearcoat",
                              {{"clearcoatFactor", 0.25},
                               {"clearcoatTexture", texture},
                               {"clearcoatRoughnessFactor", 0.125},
                               {"clearcoatRoughnessTexture", texture},
                               {"clearcoatNormalTexture", {{"index", 0}, {"scale", 2}}}}},
                             {"KHR_materials_sheen",
                              {{"sheenColorFactor", {1, 0.5, 0}},
                               {"sheenColorTexture", texture},
                               {"sheenRoughnessFactor", 0.75},
                               {"sheenRoughnessTexture", texture}}},
                             {"KHR_materials_iridescence",
                              {{"iridescenceFactor", 0.75},
                               {"iridescenceTexture", texture},
                               {"iridescenceIor", 1.5},
                               {"iridescenceThicknessMinimum", 500},
                               {"iridescenceThicknessMaximum", 200},
                               {"iridescenceThicknessTexture", texture}}},
                             {"KHR_materials_anisotropy",
                              {{"anisotropyStrength", 0.5},
                               {"anisotropyRotation", -0.25},
                               {"anisotropyTexture", texture}}},
                             {"KHR_materials_diffuse_transmission",
                              {{"diffuseTransmissionFactor", 0.75},
                               {"diffuseTransmissionTexture", texture},
                               {"diffuseTransmissionColorFactor", {1, 0.5, 0.25}},
                               {"diffuseTransmissionColorTexture", texture}}}};
    model.json["materials"] = {{{"extensions", extensions}}};
    const std::filesystem::path path = write("a.gltf", model.embedded());
    const TriangleMesh mesh = load(path);
    const Material& material = mesh.materials[0];
    EXPECT_EQ(material.ior, 1.25f);
    EXPECT_EQ(material.specular_strength, 0.5f);
    EXPECT_EQ(material.specular_tint, glm::vec3(2.0f, 1.0f, 0.5f));
    EXPECT_TRUE(material.specular_tint_texture->is_srgb);
    EXPECT_EQ(material.coat, 0.25f);
    EXPECT_EQ(material.coat_roughness, 0.125f);
    EXPECT_EQ(material.coat_normal_scale, 2.0f);
    EXPECT_EQ(material.sheen, glm::vec3(1.0f, 0.5f, 0.0f));
    EXPECT_EQ(material.sheen_roughness, 0.75f);
    EXPECT_EQ(material.film, 0.75f);
    EXPECT_EQ(material.film_ior, 1.5f);
    EXPECT_EQ(material.film_thickness_at_0, 500.0f);
    EXPECT_EQ(material.film_thickness_at_1, 200.0f);
    EXPECT_EQ(material.anisotropy, 0.5f);
    EXPECT_EQ(material.anisotropy_rotation, -0.25f);
    EXPECT_EQ(material.diffuse_transmission, 0.75f);
    EXPECT_EQ(material.diffuse_transmission_color, glm::vec3(1.0f, 0.5f, 0.25f));
    EXPECT_TRUE(material.diffuse_transmission_color_texture->is_srgb);
    for (const auto& slot :
         {material.coat_texture, material.coat_roughness_texture, material.coat_normal_texture,
          material.film_texture, material.film_thickness_texture, material.anisotropy_texture}) {
        EXPECT_FALSE(slot->is_srgb);
        EXPECT_EQ(mesh.textures[slot->texture].texels[0], (Rgb8{255, 128, 0}));
    }
    for (const auto& slot : {material.specular_strength_texture, material.sheen_roughness_texture,
                             material.diffuse_transmission_texture})
        EXPECT_EQ(mesh.textures[slot->texture].texels,
                  (std::vector<Rgb8>{{255, 255, 255}, {51, 51, 51}}))
            << "alpha";
    EXPECT_THAT(mesh.warnings, ElementsAre());
    const auto refused = [&](const char* extension, const Json& value, const char* message) {
        model.json["materials"] = {{{"extensions", {{extension, value}}}}};
        EXPECT_THAT(gltf(model.embedded()).warnings, ElementsAre(testing::HasSubstr(message)));
    };
    refused("KHR_materials_ior", {{"ior", 0.5}}, "expected 0, or 1 to 1e6, as \"ior\", got 0.5");
    refused("KHR_materials_clearcoat", {{"clearcoatFactor", 2}},
            "expected 0 to 1 as \"clearcoatFactor\", got 2: it counts as 1");
    refused("KHR_materials_sheen", {{"sheenColorFactor", {-1, 0, 0}}},
            "expected 0 to 1 as \"sheenColorFactor\", got -1");
    refused("KHR_materials_specular", {{"specularColorFactor", {-1, 0, 0}}},
            "expected 0 to 1e+06 as \"specularColorFactor\", got -1");
    refused("KHR_materials_iridescence", {{"iridescenceFactor", 1}, {"iridescenceIor", 0.5}},
            "expected 1 to 1e+06 as \"iridescenceIor\", got 0.5: it counts as 1");
    refused("KHR_materials_anisotropy", {{"anisotropyStrength", -1}},
            "expected 0 to 1 as \"anisotropyStrength\", got -1: it counts as 0");
    refused("KHR_materials_diffuse_transmission", {{"diffuseTransmissionFactor", 2}},
            "expected 0 to 1 as \"diffuseTransmissionFactor\", got 2: it counts as 1");
}

/// What a film and a stretched highlight are when the file says no more, and where a texture is
/// missing.
TEST_F(GltfTest, DefaultsOfFilmsAndAnisotropy) {
    Model model = square();
    model.json["images"] = {{{"uri", "nowhere.png"}}};
    model.json["textures"] = {{{"source", 0}}};
    const Json texture = {{"index", 0}};
    model.json["materials"] = {{{"extensions",
                                 {{"KHR_materials_iridescence",
                                   {{"iridescenceFactor", 1},
                                    {"iridescenceTexture", texture},
                                    {"iridescenceThicknessTexture", texture}}},
                                  {"KHR_materials_anisotropy",
                                   {{"anisotropyStrength", 1}, {"anisotropyTexture", texture}}}}}},
                               {{"extensions",
                                 {{"KHR_materials_iridescence", {{"iridescenceIor", 2}}},
                                  {"KHR_materials_anisotropy", {{"anisotropyRotation", 1}}}}}}};
    model.json["meshes"][0]["primitives"][0]["material"] = 0;
    const TriangleMesh mesh = gltf(model.embedded());
    const Material& material = mesh.materials[0];
    EXPECT_EQ(material.film, 1.0f);
    EXPECT_EQ(material.film_ior, 1.3f);
    EXPECT_EQ(material.film_thickness_at_0, 100.0f);
    EXPECT_EQ(material.film_thickness_at_1, 400.0f);
    EXPECT_FALSE(material.film_texture || material.film_thickness_texture ||
                 material.anisotropy_texture);
    EXPECT_EQ(material.anisotropy_rotation, 0.0f);
    ASSERT_EQ(mesh.corner_tangents.size(), mesh.num_triangles()) << "of the uvs";
    EXPECT_EQ(mesh.corner_tangents[0][0], glm::vec4(1.0f, 0.0f, 0.0f, 1.0f));
    EXPECT_EQ(mesh.materials[1].film, 0.0f) << "a factor of 0 by default";
    EXPECT_EQ(mesh.materials[1].anisotropy, 0.0f);
}

/// A mirrored frame keeps the bitangent where it is. What is no tangent is computed.
TEST_F(GltfTest, Tangents) {
    Model model = square();
    Json& primitive = model.json["meshes"][0]["primitives"][0];
    const float nan = std::numeric_limits<float>::quiet_NaN();
    primitive["attributes"]["NORMAL"] =
        model.add<glm::vec3>(std::vector<glm::vec3>(4, {0, 0, 1}), 5126, "VEC3");
    primitive["attributes"]["TANGENT"] = model.add<glm::vec4>(
        {{0, 2, 0, 1}, {0, 1, 0, -1}, {0, 0, 0, 1}, {nan, 0, 0, 1}}, 5126, "VEC4");
    primitive["material"] = 0;
    model.json["images"] = {{{"uri", "data:image/png;base64," + base64(four_colors())}}};
    model.json["textures"] = {{{"source", 0}}};
    model.json["materials"] = {{{"normalTexture", {{"index", 0}, {"scale", 0.5}}}}};
    const TriangleMesh mesh = gltf(model.embedded());
    EXPECT_EQ(mesh.materials[0].normal_scale, 0.5f);
    const auto tangent_of = [&](const TriangleMesh& of, std::uint32_t vertex) {
        for (std::size_t i = 0; i < of.num_triangles(); ++i)
            for (std::size_t k = 0; k < 3; ++k)
                if (of.triangles[i][k] == vertex)
                    return of.corner_tangents[i][k];
        return glm::vec4(0.0f);
    };
    EXPECT_EQ(tangent_of(mesh, 0), glm::vec4(0, 1, 0, 1));
    EXPECT_EQ(tangent_of(mesh, 1), glm::vec4(0, 1, 0, -1));
    for (const std::uint32_t vertex : {2u, 3u})
        EXPECT_NEAR(std::abs(tangent_of(mesh, vertex).x), 1.0f, 1e-6f);
    EXPECT_THAT(mesh.warnings,
                ElementsAre(testing::HasSubstr("tangents are zero or not finite at ")));
    model.json["nodes"][0]["scale"] = {1, -1, 1};
    EXPECT_EQ(tangent_of(gltf(model.embedded()), 0), glm::vec4(0, -1, 0, -1));
    // Those of flat faces do not count [glTF 2.0, 3.7.2.1].
    model.json["nodes"][0].erase("scale");
    model.json["meshes"][0]["primitives"][0]["attributes"].erase("NORMAL");
    EXPECT_NEAR(std::abs(tangent_of(gltf(model.embedded()), 0).x), 1.0f, 1e-6f);
    EXPECT_THAT(gltf(model.embedded()).warnings, ElementsAre());
    // Without a normal map they are not needed.
    model.json["materials"] = {Json::object()};
    EXPECT_TRUE(gltf(model.embedded()).corner_tangents.empty());
    EXPECT_THAT(gltf(model.embedded()).warnings, ElementsAre());
}

/// Neither a material nor an image ends the load: the surface is grey, or without its texture.
TEST_F(GltfTest, WhatCannotBeReadIsGreyWithAWarning) {
    const auto warned = [](const Json& pbr, const std::string& image, const std::string& part) {
        Model model = square();
        model.json["images"] = {{{"uri", "data:image/png;base64," + base64(image)}}};
        model.json["textures"] = {{{"source", 0}}};
        model.json["materials"] = {{{"name", "paint"}, {"pbrMetallicRoughness", pbr}}};
        model.json["meshes"][0]["primitives"][0]["material"] = 0;
        TriangleMesh mesh = gltf(model.embedded());
        EXPECT_THAT(mesh.warnings, ElementsAre(testing::HasSubstr(part)));
        return mesh.materials.at(0);
    };
    const Material grey{.name = "paint", .base_color = glm::vec3(0.5f)};
    EXPECT_EQ(warned({{"roughnessFactor", "much"}}, "",
                     "the material paint is grey, since it cannot be read: material 0: expected a "
                     "number as \"roughnessFactor\""),
              grey);
    const Material bright =
        warned({{"roughnessFactor", 2}, {"baseColorFactor", {1, 0.5, 0, 1}}}, "",
               "the material paint: expected 0 to 1 as \"roughnessFactor\", "
               "got 2: it counts as 1");
    EXPECT_EQ(bright.roughness, 1.0f);
    EXPECT_EQ(bright.base_color, glm::vec3(1.0f, 0.5f, 0.0f)) << "the others stay";
    EXPECT_EQ(warned({{"baseColorFactor", {1, 1, 1}}}, "", "4 numbers"), grey);
    EXPECT_EQ(warned({{"baseColorTexture", {{"index", 7}}}}, "", "indices of \"textures\""), grey);
    const Json textured = {{"baseColorFactor", {0.25, 0.5, 0.75, 1}},
                           {"baseColorTexture", {{"index", 0}}}};
    for (const auto& [image, part] :
         {std::pair<std::string, const char*>{"abc", "expected a PNG"},
          {"\xabKTX 20\xbb\r\n\x1a\n", "got KTX 2, which is not read"}}) {
        const Material plain = warned(textured, image, part);
        EXPECT_EQ(plain.base_color, glm::vec3(0.25f, 0.5f, 0.75f));
        EXPECT_FALSE(plain.base_color_texture);
    }
}

TEST_F(GltfTest, RoundingsAboveOneAreOne) {
    Model model = square();
    model.json["materials"] = {
        {{"pbrMetallicRoughness",
          {{"baseColorFactor", {1.00000012, -1e-7, 1, 1}}, {"metallicFactor", 1.00001}}}}};
    const TriangleMesh mesh = gltf(model.embedded());
    EXPECT_THAT(mesh.warnings, ElementsAre());
    EXPECT_EQ(mesh.materials[0].base_color, glm::vec3(1, 0, 1));
    EXPECT_EQ(mesh.materials[0].metallic, 1.0f);
}

/// Sparse accessors replace elements of a buffer view, or of zeros where there is none.
TEST_F(GltfTest, SparseAccessors) {
    Model model = square();
    const std::vector<std::uint8_t> places = {1, 3};
    const auto indices = model.add_view({places.begin(), places.end()});
    const std::vector<glm::vec3> values = {{5, 6, 7}, {8, 9, 10}};
    const auto bytes =
        model.add_view({reinterpret_cast<const char*>(values.data()), 2 * sizeof(glm::vec3)});
    const Json sparse = {{"count", 2},
                         {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                         {"values", {{"bufferView", bytes}}}};
    model.json["accessors"][0]["sparse"] = sparse;
    const auto positions = [&] { // flat faces repeat them
        return gltf(model.embedded(), NormalSource::Smooth).positions;
    };
    EXPECT_THAT(positions(),
                ElementsAre(glm::vec3(0, 0, 0), values[0], glm::vec3(1, 1, 0), values[1]));
    model.json["accessors"][0].erase("bufferView");
    EXPECT_THAT(positions(), ElementsAre(glm::vec3(0), values[0], glm::vec3(0), values[1]));

    const auto refused = [&](const char* key, const char* inner, const Json& value,
                             const std::string& part) {
        Model broken = model;
        Json& changed = broken.json["accessors"][0]["sparse"];
        (inner == nullptr ? changed[key] : changed[key][inner]) = value;
        expect_refusal([&] { return gltf(broken.embedded()); }, part);
    };
    refused("count", nullptr, 3, "indices of accessor 0 inside its buffer view of 2 bytes, got 3");
    refused("indices", "componentType", 5120, "unsigned integers");
    refused("values", "byteOffset", 1, "values of accessor 0 inside");
    refused("values", "bufferView", 99, "\"bufferViews\" below");
    model.json["accessors"][0]["count"] = 3;
    expect_refusal([&] { return gltf(model.embedded()); },
                   "sparse indices of accessor 0 below 3, got 3");
    model.json["accessors"][0]["count"] = 1e12;
    expect_refusal([&] { return gltf(model.embedded()); },
                   "half of the free memory; got one of 1.2");
}

/// The WebP image comes before its twin; the twin serves where the WebP file is gone.
TEST_F(GltfTest, WebpAndItsTwin) {
    Model model = square();
    static_cast<void>(write("four.png", four_colors()));
    static_cast<void>(write("blue.webp", webp(2, 1, {{0, 0, 255, 9}, {0, 0, 255, 255}})));
    model.json["images"] = {{{"uri", "four.png"}}, {{"uri", "blue.webp"}}};
    model.json["textures"] = {
        {{"source", 0}, {"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}}};
    model.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    model.json["extensionsUsed"] = {"EXT_texture_webp"};
    const auto path = write("a.gltf", model.embedded());
    TriangleMesh mesh = load(path);
    ASSERT_EQ(mesh.textures.size(), 1u);
    EXPECT_EQ(mesh.textures[0].name, "blue.webp");
    EXPECT_EQ(mesh.textures[0].texels, (std::vector<Rgb8>{Blue, Blue}));
    EXPECT_THAT(mesh.warnings, ElementsAre());
    std::filesystem::remove(folder_ / "blue.webp");
    mesh = load(path);
    EXPECT_EQ(mesh.textures[0].name, "four.png");
    EXPECT_THAT(mesh.missing, ElementsAre("blue.webp"));
    const std::string whole = webp(2, 1, {{0, 0, 255, 9}, {0, 0, 255, 255}});
    static_cast<void>(write("blue.webp", whole.substr(0, whole.size() - 4)));
    EXPECT_EQ(load(path).textures[0].name, "four.png");
    EXPECT_THAT(load(path).warnings,
                ElementsAre(testing::StartsWith("the image blue.webp is left out: expected a")));
}

TEST_F(GltfTest, SpecularGlossiness) {
    Model model = square();
    const std::string image = webp(2, 1, {{255, 128, 0, 255}, {0, 0, 0, 51}});
    static_cast<void>(write("specular.webp", image));
    static_cast<void>(write("four.png", four_colors()));
    model.json["images"] = {{{"uri", "four.png"}}, {{"uri", "specular.webp"}}};
    model.json["textures"] = {{{"source", 0}}, {{"source", 1}}};
    const Json extension = {{"diffuseFactor", {0.5, 0.25, 1, 1}},
                            {"diffuseTexture", {{"index", 0}}},
                            {"specularFactor", {0.5, 1, 1}},
                            {"glossinessFactor", 0.8},
                            {"specularGlossinessTexture", {{"index", 1}}}};
    model.json["materials"] = {
        {{"extensions", {{"KHR_materials_pbrSpecularGlossiness", extension}}},
         {"pbrMetallicRoughness", {{"roughnessFactor", 0.125}}}},
        {{"extensions", {{"KHR_materials_pbrSpecularGlossiness", Json::object()}}}}};
    model.json["extensionsRequired"] = {"KHR_materials_pbrSpecularGlossiness"};
    const TriangleMesh mesh = load(write("a.gltf", model.embedded()));
    const Material& material = mesh.materials[0];
    EXPECT_EQ(material.model, MaterialModel::SpecularGlossiness);
    EXPECT_EQ(material.base_color, glm::vec3(0.5f, 0.25f, 1.0f));
    EXPECT_EQ(material.specular, glm::vec3(0.5f, 1.0f, 1.0f));
    EXPECT_EQ(mesh.textures[material.base_color_texture->texture].name, "four.png");
    EXPECT_EQ(mesh.textures[material.specular_texture->texture].texels,
              (std::vector<Rgb8>{{255, 128, 0}, {0, 0, 0}}));
    EXPECT_TRUE(material.specular_texture->is_srgb);
    // 1 - 0.8 * alpha, in bytes.
    EXPECT_EQ(material.roughness, 1.0f);
    const Texture& roughness = mesh.textures[material.metallic_roughness_texture->texture];
    EXPECT_FALSE(material.metallic_roughness_texture->is_srgb);
    EXPECT_EQ(roughness.texels, (std::vector<Rgb8>{{51, 51, 51}, {214, 214, 214}}));
    EXPECT_EQ(mesh.materials[1].specular, glm::vec3(1.0f)) << "the extension's default";
    EXPECT_EQ(mesh.materials[1].roughness, 0.0f);
    model.json["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"]
              ["specularFactor"] = {2, 0, 0};
    EXPECT_THAT(gltf(model.embedded()).warnings,
                testing::Contains(testing::HasSubstr(
                    "expected 0 to 1 as \"specularFactor\", got 2: it counts as 1")));
}

/// As assimp writes it: opacity is beside the extension alone.
TEST_F(GltfTest, AlphaBesideSpecularGlossinessCountsWhereItWouldBeOpaque) {
    Model model = square();
    const auto material = [](double of_extension, double beside, const char* mode) {
        return Json{{"name", mode},
                    {"alphaMode", mode},
                    {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, beside}}}},
                    {"extensions",
                     {{"KHR_materials_pbrSpecularGlossiness",
                       {{"diffuseFactor", {1, 1, 1, of_extension}}}}}}};
    };
    model.json["materials"] = {material(1.0, 0.25, "BLEND"), material(0.5, 0.25, "BLEND"),
                               material(1.0, 1.0, "BLEND"), material(1.0, 0.25, "OPAQUE")};
    const TriangleMesh mesh = load(write("a.gltf", model.embedded()));
    EXPECT_EQ(mesh.materials[0].alpha, 0.25f);
    EXPECT_EQ(mesh.materials[1].alpha, 0.5f) << "the extension says it";
    EXPECT_EQ(mesh.materials[2].alpha, 1.0f);
    EXPECT_EQ(mesh.materials[3].alpha_mode, AlphaMode::Opaque);
    EXPECT_THAT(mesh.warnings,
                ElementsAre("the material BLEND is to be blended, with an alpha of 1 in "
                            "KHR_materials_pbrSpecularGlossiness and 0.25 in baseColorFactor: it "
                            "has 0.25"));
}

TEST_F(GltfTest, AlphaCutsOut) {
    Model model = square();
    static_cast<void>(write("leaf.webp", webp(2, 1, {{255, 128, 0, 255}, {0, 0, 0, 51}})));
    static_cast<void>(write("opaque.png", four_colors()));
    model.json["images"] = {{{"uri", "leaf.webp"}}, {{"uri", "opaque.png"}}};
    model.json["textures"] = {{{"source", 0}}, {{"source", 1}}};
    const auto textured = [](int texture) {
        return Json{{"baseColorFactor", {1, 1, 1, 0.5}},
                    {"baseColorTexture", {{"index", texture}}}};
    };
    model.json["materials"] = {
        {{"alphaMode", "MASK"}, {"alphaCutoff", 0.25}, {"pbrMetallicRoughness", textured(0)}},
        {{"alphaMode", "MASK"}, {"doubleSided", true}, {"pbrMetallicRoughness", textured(1)}},
        {{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", textured(0)}},
        {{"pbrMetallicRoughness", textured(0)}},
        {{"alphaMode", "CUT"}},
        {{"alphaMode", "MASK"}, {"alphaCutoff", -1}}};
    const TriangleMesh mesh = load(write("a.gltf", model.embedded()));
    const Material& leaf = mesh.materials[0];
    EXPECT_EQ(leaf.alpha_mode, AlphaMode::Mask);
    EXPECT_EQ(leaf.alpha_cutoff, 0.25f);
    EXPECT_EQ(leaf.alpha, 0.5f);
    EXPECT_FALSE(leaf.is_double_sided);
    EXPECT_EQ(mesh.textures[leaf.alpha_texture->texture].texels,
              (std::vector<Rgb8>{{255, 255, 255}, {51, 51, 51}}));
    EXPECT_FALSE(leaf.alpha_texture->is_srgb);
    // 0.5 times 1 is above the cutoff, 0.5 times 0.2 below.
    EXPECT_EQ(veil(mesh, 0, glm::vec2(0.0f)), Veil());
    EXPECT_EQ(mesh.materials[1].alpha_cutoff, 0.5f) << "the default";
    EXPECT_TRUE(mesh.materials[1].is_double_sided);
    EXPECT_FALSE(mesh.materials[1].alpha_texture) << "an image without alpha";
    EXPECT_FALSE(lets_light_pass(mesh.materials[1])) << "0.5 is not below 0.5";
    EXPECT_EQ(mesh.materials[2].alpha_mode, AlphaMode::Blend);
    EXPECT_EQ(mesh.materials[2].alpha_texture->texture, leaf.alpha_texture->texture);
    EXPECT_FALSE(mesh.materials[3].alpha_texture) << "alpha of opaque materials means nothing";
    EXPECT_THAT(
        mesh.warnings,
        testing::IsSupersetOf(
            {testing::HasSubstr("expected OPAQUE, MASK or BLEND as \"alphaMode\", got 'CUT'"),
             testing::HasSubstr("expected a number of 0 or more as \"alphaCutoff\", got -1")}));
}

TEST_F(GltfTest, Glass) {
    Model model = square();
    const Json volume = {{"thicknessFactor", 0.5},
                         {"attenuationDistance", 2},
                         {"attenuationColor", {1, 0.5, 0.25}},
                         {"thicknessTexture", {{"index", 0}}}};
    const Json clear = {{"KHR_materials_transmission", {{"transmissionFactor", 0.75}}},
                        {"KHR_materials_dispersion", {{"dispersion", 0.5}}}};
    Json body = clear;
    body["KHR_materials_volume"] = volume;
    model.json["materials"] = {{{"extensions", clear}},
                               {{"extensions", body}},
                               {{"extensions", {{"KHR_materials_volume", volume}}}}};
    TriangleMesh mesh = gltf(model.embedded());
    EXPECT_EQ(mesh.materials[0].transmission, 0.75f);
    EXPECT_EQ(mesh.materials[0].thickness, 0.0f);
    EXPECT_EQ(mesh.materials[1].thickness, 0.5f);
    EXPECT_EQ(mesh.materials[1].attenuation_distance, 2.0f);
    EXPECT_EQ(mesh.materials[1].dispersion, 0.5f);
    EXPECT_EQ(mesh.materials[0].dispersion, 0.0f) << "sheets do not bend";
    EXPECT_EQ(mesh.materials[1].attenuation_color, glm::vec3(1.0f, 0.5f, 0.25f));
    EXPECT_FALSE(lets_light_pass(mesh.materials[2])) << "opaque";
    EXPECT_THAT(
        mesh.warnings,
        testing::UnorderedElementsAre(
            "2 materials of glass (KHR_materials_transmission): light goes straight on and its "
            "shadows are grey; pictures of vertices refract",
            "2 materials with a texture of thickness, which is not read: the factor counts "
            "everywhere"));
    model.json["materials"][1]["extensions"]["KHR_materials_volume"]["thicknessFactor"] = -1;
    EXPECT_THAT(gltf(model.embedded()).warnings,
                testing::Contains(testing::HasSubstr(
                    "expected a number of 0 or more as \"thicknessFactor\", got -1")));
}

/// A body so thick that no light crosses it is one that light leaves where it entered.
TEST_F(GltfTest, Milk) {
    Model model = square();
    const auto body = [](const char* through, double part, double distance, const char* color) {
        Json result = {
            {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0, 1, 1}}, {"metallicFactor", 0}}}};
        result["extensions"] = {
            {"KHR_materials_volume",
             {{"thicknessFactor", 1},
              {"attenuationDistance", distance},
              {"attenuationColor", {0.5, 0.25, 0.5}}}},
            {"KHR_materials_volume_scatter", {{color, {0.25, 0.5, 0.75}}}},
        };
        const bool is_glass = through[0] == 't';
        result["extensions"][is_glass ? "KHR_materials_transmission"
                                      : "KHR_materials_diffuse_transmission"] = {{through, part}};
        return result;
    };
    // 0.5 to the power of 4 is above a twentieth, to that of 5 below.
    model.json["materials"] = {body("transmissionFactor", 1.0, 0.2, "multiscatterColorFactor"),
                               body("diffuseTransmissionFactor", 0.5, 0.2, "multiscatterColor"),
                               body("transmissionFactor", 1.0, 0.25, "multiscatterColorFactor")};
    const TriangleMesh mesh = gltf(model.embedded());
    EXPECT_EQ(mesh.materials[0].base_color, glm::vec3(0.25f, 0.5f, 0.75f));
    EXPECT_FALSE(lets_light_pass(mesh.materials[0]));
    EXPECT_EQ(mesh.materials[1].base_color, glm::vec3(0.375f, 0.25f, 0.875f));
    EXPECT_EQ(mesh.materials[1].diffuse_transmission, 0.0f);
    EXPECT_EQ(mesh.materials[2].transmission, 1.0f);
    EXPECT_EQ(mesh.materials[2].base_color, glm::vec3(0.5f, 0.0f, 1.0f));
    EXPECT_THAT(mesh.warnings,
                testing::IsSupersetOf({testing::StartsWith("3 materials with "
                                                           "KHR_materials_volume_scatter, a draft"),
                                       testing::StartsWith("1 material of glass")}));
}

TEST_F(GltfTest, NamesInLatin1) {
    Model model = square();
    static_cast<void>(write("gr\xfcn.png", four_colors()));
    model.json["nodes"][0]["name"] = "w\xc3\xa4nde";
    model.json["images"] = {{{"uri", "gr?n.png"}}};
    model.json["textures"] = {{{"source", 0}}};
    model.json["materials"] = {
        {{"name", "gr?n"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    const TriangleMesh mesh =
        load(write("a.gltf", replace_all(model.embedded(), "gr?n", "gr\xfcn")));
    EXPECT_THAT(mesh.groups, ElementsAre("w\xc3\xa4nde")) << "UTF-8 stays";
    EXPECT_EQ(mesh.materials[0].name, "gr\xc3\xbcn");
    EXPECT_THAT(mesh.missing, ElementsAre());
    EXPECT_EQ(mesh.textures.size(), 1u);
}

TEST_F(GltfTest, Instances) {
    Model model = square();
    const double h = std::sqrt(0.5);
    using Rotation = std::array<std::int16_t, 4>;
    const auto turn = static_cast<std::int16_t>(std::lround(h * 32767));
    const Json attributes = {
        {"TRANSLATION", model.add<glm::vec3>({{0, 0, 0}, {5, 0, 0}}, 5126, "VEC3")},
        {"ROTATION",
         model.add<Rotation>({{0, 0, 0, 32767}, {0, turn, 0, turn}}, 5122, "VEC4", true)},
        {"SCALE", model.add<glm::vec3>({{1, 1, 1}, {-1, 2, 1}}, 5126, "VEC3")},
        {"_TEMPERATURE", 0}};
    model.json["nodes"] = {
        {{"mesh", 0},
         {"translation", {0, 0, 100}},
         {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}}};
    model.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    const TriangleMesh mesh = gltf(model.embedded());
    EXPECT_EQ(defect(mesh), "");
    ASSERT_EQ(mesh.num_vertices(), 8u);
    EXPECT_EQ(mesh.positions[2], glm::vec3(1, 1, 100));
    // (1, 1) is mirrored and stretched, then turned by 90 degrees about +Y, then moved.
    EXPECT_LT(glm::distance(mesh.positions[6], glm::vec3(5, 2, 101)), 1e-4f);
    EXPECT_EQ(mesh.triangles[2], (Triangle{4, 6, 5})) << "mirrored: turned back";
    Json& changed = model.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    changed["SCALE"] = 0;
    expect_refusal([&] { return gltf(model.embedded()); },
                   "2 elements of SCALE, as many as of the instances' other attributes");
    changed = {{"_TEMPERATURE", 0}};
    expect_refusal([&] { return gltf(model.embedded()); },
                   "TRANSLATION, ROTATION or SCALE of a node's instances, got none");
}

TEST_F(GltfTest, SaysWhatIsLeftOut) {
    Model model = square();
    EXPECT_THAT(gltf(model.embedded()).warnings, ElementsAre());
    model.json["extensionsUsed"] = {"KHR_materials_volume_scatter", "VENDOR_wind",
                                    "KHR_texture_basisu",           "KHR_texture_transform",
                                    "KHR_materials_volume_scatter", "EXT_lights_image_based"};
    model.json["extensionsRequired"] = {"KHR_texture_basisu"};
    const Json coats = {{"KHR_materials_volume_scatter", {{"multiscatterColor", {0.5, 1, 1}}}},
                        {"KHR_materials_diffuse_transmission", {{"diffuseTransmissionFactor", 0}}},
                        {"KHR_materials_clearcoat", {{"clearcoatFactor", 0.5}}},
                        {"KHR_materials_sheen", {{"sheenColorFactor", {0.5, 0, 0}}}},
                        {"KHR_materials_specular", {{"specularColorFactor", {0.5, 1, 1}}}},
                        {"KHR_materials_ior", {{"ior", 1.25}}},
                        {"EXT_materials_bump", {{"bumpFactor", 1}}},
                        {"VENDOR_fur", {{"length", 2}}}};
    model.json["samplers"] = {{{"magFilter", 9728}}};
    model.json["textures"] = {{{"sampler", 0}}};
    model.json["materials"] = {
        {{"alphaMode", "MASK"}, {"doubleSided", true}},
        {{"alphaMode", "MASK"}, {"doubleSided", false}, {"extensions", coats}},
        {{"alphaMode", "OPAQUE"}, {"occlusionTexture", {{"index", 0}}}},
        {{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}},
        {{"normalTexture", {{"index", 0}}}, {"emissiveFactor", {0, 0, 1}}, {"shiny", true}}};
    Json& meshes = model.json["meshes"];
    meshes[0]["primitives"].push_back({{"mode", 1}, {"attributes", {{"POSITION", 0}}}});
    meshes[0]["primitives"][0]["targets"] = {{{"TEXCOORD_0", 1}}};
    model.json["animations"] = {{{"name", "Walk"}}};
    model.json["scenes"].push_back({{"nodes", {0}}});
    EXPECT_THAT(
        gltf(model.embedded()).warnings,
        testing::UnorderedElementsAre(
            "the extension 'KHR_texture_basisu' is not read: its images are left out; without "
            "another image, a surface has its factors alone. python3 -m relumine reads them: pip "
            "install relumine[basis]",
            "the extension 'VENDOR_wind' is not read: what it describes is left out",
            "the extension 'EXT_lights_image_based' is not read: the file brings its own "
            "environment, which does not light the scene",
            "1 material with KHR_materials_volume_scatter, a draft: bodies are clear inside, not "
            "milky",
            "1 material with 'VENDOR_fur', which is not read: what it describes is left out",
            "1 material with 'EXT_materials_bump', which is not read: what it describes is left "
            "out",
            "1 material with an occlusion map, which is not read: rays find what blocks the light",
            "2 materials with textures of hard pixels (NEAREST), which are not kept: they are "
            "sampled bilinearly",
            "1 material with the property 'shiny', which glTF does not have: it is left out",
            "1 primitive of points or lines: only triangles are read",
            "morph targets of colours and uvs: only shapes are read",
            "1 of 2 scenes: the default one is read",
            "1 animation: nodes stand as they are; --pose ANIMATION@SECONDS chooses a moment"));
}

TEST_F(GltfTest, EmissionAndUnlit) {
    Model model = square();
    model.json["materials"] = {
        {{"emissiveFactor", {1.0, 0.5, 0.0}},
         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8.0}}}}}},
        {{"pbrMetallicRoughness", {{"baseColorFactor", {1.0, 0.5, 0.25, 1.0}}}},
         {"emissiveFactor", {1.0, 1.0, 1.0}},
         {"extensions", {{"KHR_materials_unlit", Json::object()}}}}};
    const TriangleMesh mesh = gltf(model.embedded());
    EXPECT_EQ(mesh.materials[0].emission, glm::vec3(8.0f, 4.0f, 0.0f));
    EXPECT_EQ(mesh.materials[1].model, MaterialModel::Unlit);
    EXPECT_EQ(mesh.materials[1].base_color, glm::vec3(1.0f, 0.5f, 0.25f));
    EXPECT_EQ(mesh.materials[1].emission, glm::vec3(0.0f)) << "unlit ones have their colour alone";
    for (const auto& [strength, said] :
         {std::pair(Json(-1.0), "it counts as 0"), std::pair(Json(1e30), "it counts as 1e+09"),
          std::pair(Json("NaN"), "the material material 0 is grey, since it cannot be read")}) {
        model.json["materials"][0]["extensions"]["KHR_materials_emissive_strength"] = {
            {"emissiveStrength", strength}};
        const TriangleMesh broken = gltf(model.embedded());
        ASSERT_FALSE(broken.warnings.empty());
        EXPECT_THAT(broken.warnings[0], testing::HasSubstr(said));
    }
    // What tools write that have no strength.
    model.json["materials"][0].erase("extensions");
    model.json["materials"][0]["emissiveFactor"] = {2.0, 0.5, 0.0};
    const TriangleMesh strong = gltf(model.embedded());
    EXPECT_EQ(strong.materials[0].emission, glm::vec3(2.0f, 0.5f, 0.0f));
    EXPECT_THAT(strong.warnings, testing::IsEmpty());
}

TEST_F(GltfTest, RefusesWhatItWouldMisread) {
    const auto refused = [](const auto& change, const std::string& part) {
        Model model = square();
        change(model.json);
        expect_refusal([&] { return gltf(model.embedded()); }, part);
    };
    expect_refusal([] { return gltf(""); }, "JSON");
    expect_refusal([] { return gltf("{\"asset\": "); }, "syntax error at byte");
    expect_refusal([] { return gltf("[]"); }, "object");
    expect_refusal([] { return gltf("{}"); }, "glTF version 2, got 'none'");
    expect_refusal([] { return gltf("{\"asset\":{\"version\":\"2.0\"},\"x\":1e999}"); },
                   "out of range");
    expect_refusal([this] { return load(write("a.gltf", square().external("gone.bin"))); },
                   "the file 'gone.bin' beside it");
    expect_refusal([] { return gltf(square().external("data:,x")); }, "base64");
    expect_refusal([] { return gltf(square().external("data:;base64,%%%%")); }, "base64");
    expect_refusal([] { return gltf(square().external("data:;base64,AAAA")); }, "got 3");
    refused([](Json& j) { j["asset"]["version"] = "1.0"; }, "got '1.0'");
    refused([](Json& j) { j["extensionsRequired"] = {"VENDOR_other_geometry"}; },
            "VENDOR_other_geometry");
    refused([](Json& j) { j["nodes"][0]["mesh"] = 1; }, "indices of \"meshes\" below 1, got 1");
    refused([](Json& j) { j["nodes"][0]["mesh"] = -1; }, "a whole number as \"mesh\", got '-1'");
    refused([](Json& j) { j["nodes"][0]["mesh"] = "0"; }, "a whole number as \"mesh\"");
    refused([](Json& j) { j["nodes"][0]["children"] = {0}; }, "one parent");
    refused([](Json& j) { j["nodes"][0]["children"] = {7}; }, "indices of \"nodes\"");
    refused([](Json& j) { j["nodes"][0]["matrix"] = {1, 2}; }, "16 numbers");
    refused([](Json& j) { j["nodes"][0]["rotation"] = {0, 0, 0, 0}; }, "quaternion");
    refused([](Json& j) { j["nodes"][0]["scale"] = {1e300, 1e300, 1}; }, "finite positions");
    refused([](Json& j) { j["scene"] = 4; }, "indices of \"scenes\"");
    refused([](Json& j) { j["scenes"][0]["nodes"] = Json::array(); }, "vertices, got none");
    refused([](Json& j) { j["accessors"][0]["count"] = 5; },
            "accessor 0 inside its buffer view of 48 bytes, got 5");
    refused([](Json& j) { j["accessors"][0]["count"] = 1e12; }, "accessor 0 inside");
    refused([](Json& j) { j["accessors"][0]["count"] = 1e30; }, "whole number");
    refused([](Json& j) { j["accessors"][0]["count"] = 0; }, "got 0 elements");
    refused([](Json& j) { j["accessors"][0]["byteOffset"] = 40; }, "accessor 0 inside");
    refused([](Json& j) { j["accessors"][0]["type"] = "VEC2"; },
            "3 components of accessor 0, got 2");
    refused([](Json& j) { j["accessors"][0]["type"] = "MAT3"; }, "MAT3");
    refused([](Json& j) { j["accessors"][0]["componentType"] = 5130; }, "5130");
    refused([](Json& j) { j["accessors"][1]["count"] = 3; }, "4 elements of TEXCOORD_0");
    refused([](Json& j) { j["accessors"][2]["componentType"] = 5126; }, "accessor 2");
    refused([](Json& j) { j["accessors"][2]["componentType"] = 5122; }, "unsigned integers");
    refused([](Json& j) { j["accessors"][2]["count"] = 5; }, "a multiple of 3");
    refused([](Json& j) { j["accessors"][2].update({{"bufferView", 0}, {"byteOffset", 12}}); },
            "vertex indices below 4, got 16256");
    refused([](Json& j) { j["bufferViews"][0]["byteLength"] = 4096; }, "buffer view 0 inside");
    refused([](Json& j) { j["bufferViews"][0]["byteOffset"] = 1e12; }, "buffer view 0 inside");
    refused([](Json& j) { j["bufferViews"][0]["byteStride"] = 4; }, "byteStride of 12");
    refused([](Json& j) { j["meshes"][0]["primitives"][0]["material"] = 0; },
            "indices of \"materials\" below 0");
    refused([](Json& j) { j["meshes"][0]["primitives"][0]["mode"] = 9; }, "mode");
    refused([](Json& j) { j["meshes"] = 3; }, "\"meshes\"");
    std::string glb = square().glb();
    glb[4] = 1;
    expect_refusal([&] { return gltf(glb); }, "version 2 of .glb, got 1");
    expect_refusal([] { return gltf(square().glb().substr(0, 100)); },
                   "bytes that the .glb file declares");
    expect_refusal([] { return gltf("glTF"); }, "20 bytes");
}

/// Deep nesting, which recursion would not survive.
TEST_F(GltfTest, RepetitionHasALimit) {
    // 6 vertices and triangles, times primitives, times nodes.
    const auto repeated = [](std::size_t num_primitives, std::size_t num_nodes) {
        Model model = square();
        Json& primitives = model.json["meshes"][0]["primitives"];
        primitives = Json::array();
        for (std::size_t i = 0; i < num_primitives; ++i)
            primitives.push_back({{"attributes", {{"POSITION", 0}}}, {"indices", 2}});
        model.json["nodes"] = Json::array();
        model.json["scenes"][0]["nodes"] = Json::array();
        for (std::size_t i = 0; i < num_nodes; ++i) {
            model.json["nodes"].push_back({{"mesh", 0}});
            model.json["scenes"][0]["nodes"].push_back(i);
        }
        return model.embedded();
    };
    const auto read = [](const std::string& file, std::uint64_t max_bytes) {
        return read_gltf(bytes_of(file), {}, {.max_bytes = max_bytes});
    };
    const std::string file = repeated(2000, 20);
    EXPECT_EQ(read(file, 1u << 26).positions.size(), 4u * 2000 * 20);
    expect_refusal(
        [&] { return read(file, 1u << 24); },
        "a mesh that fits into 0.0168 GB, half of the free memory; got one of 0.0168 GB or more");
    // What fits is read, however small the file is: 4,000,000 vertices here.
    EXPECT_EQ(gltf(repeated(1000, 1000)).num_vertices(), 4u * 1000 * 1000);
}

TEST_F(GltfTest, DeepFilesAreRefusedOrRead) {
    std::string deep(200000, '[');
    deep += std::string(200000, ']');
    expect_refusal([&] { return gltf("{\"asset\":{\"version\":" + deep + "}}"); },
                   "more than 100 levels of nesting");
    Model model = square();
    for (std::size_t i = 1; i < 20000; ++i) {
        model.json["nodes"].push_back({{"mesh", 0}});
        model.json["nodes"][i - 1] = {{"children", {i}}};
    }
    EXPECT_EQ(gltf(model.embedded()).num_vertices(), 4u);
}

TEST_F(GltfTest, TheFirstPerspectiveCameraIsKept) {
    Model model = square();
    model.json["cameras"] = {
        {{"type", "orthographic"},
         {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"zfar", 9}, {"znear", 1}}}},
        {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}};
    const double h = std::sqrt(0.5);
    model.json["nodes"] = {{{"mesh", 0}, {"children", {1, 2}}},
                           {{"camera", 0}, {"translation", {1, 1, 1}}},
                           // Turned by 90 degrees about +Y: it looks along -X.
                           {{"camera", 1},
                            {"translation", {7, 2, 0}},
                            {"rotation", {0, h, 0, h}},
                            {"scale", {3, 3, 3}}}};
    model.json["scenes"] = {{{"nodes", {0}}}};
    const std::optional<Camera> camera = load(write("a.gltf", model.embedded())).camera;
    ASSERT_TRUE(camera);
    EXPECT_LT(glm::distance(camera->eye, {7, 2, 0}), 1e-5f);
    // As far ahead as the middle of the square, at x = 0.5, is.
    EXPECT_LT(glm::distance(camera->target, {0.5f, 2, 0}), 1e-5f);
    EXPECT_NEAR(camera->fov_degrees, 28.64789f, 1e-4f);
    EXPECT_EQ(camera->roll_degrees, 0.0f);
    model.json["cameras"][0]["orthographic"]["ymag"] = 0;
    model.json["cameras"][1]["perspective"]["yfov"] = 0;
    EXPECT_FALSE(load(write("b.gltf", model.embedded())).camera);
}

TEST_F(GltfTest, CamerasMayBeTurnedAboutTheirView) {
    const auto camera_with = [&](const Json& rotation) {
        Model model = square();
        model.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}}}}};
        model.json["nodes"].push_back(
            {{"camera", 0}, {"translation", {0.5, 0.5, 5}}, {"rotation", rotation}});
        model.json["scenes"][0]["nodes"].push_back(1);
        return load(write("a.gltf", model.embedded())).camera.value();
    };
    const auto near = [](const glm::vec3& a, const glm::vec3& b) {
        return glm::distance(a, b) < 1e-5f;
    };
    const double h = std::sqrt(0.5), e = std::numbers::pi / 8;
    const Camera rolled = camera_with({0, 0, std::sin(e), std::cos(e)});
    EXPECT_NEAR(rolled.roll_degrees, 45.0f, 1e-4f);
    const auto axes = rolled_axes({0, 0, -1}, rolled.roll_degrees);
    EXPECT_TRUE(near(axes.up, {-h, h, 0})) << "+Y of the node";
    EXPECT_TRUE(near(axes.right, {h, h, 0}));
    // Straight down: level is -Z, and a quarter of a turn more is -X.
    EXPECT_EQ(camera_with({-h, 0, 0, h}).roll_degrees, 0.0f);
    const Camera down = camera_with({-0.5, 0.5, 0.5, 0.5});
    EXPECT_NEAR(down.roll_degrees, 90.0f, 1e-3f);
    EXPECT_TRUE(near(rolled_axes({0, -1, 0}, down.roll_degrees).up, {-1, 0, 0}));
}

TEST_F(GltfTest, OrthographicCamerasLookFromAfar) {
    Model model = square();
    model.json["cameras"] = {
        {{"type", "orthographic"},
         {"orthographic", {{"xmag", 3}, {"ymag", 2}, {"zfar", 9}, {"znear", 1}}}}};
    model.json["nodes"].push_back({{"camera", 0}, {"translation", {0.5, 0.25, 5}}});
    model.json["scenes"][0]["nodes"].push_back(1);
    const LoadedMesh mesh = load(write("a.gltf", model.embedded()));
    ASSERT_TRUE(mesh.camera);
    const float distance = glm::distance(mesh.camera->eye, mesh.camera->target);
    EXPECT_GT(distance, 100.0f);
    EXPECT_LT(glm::distance(mesh.camera->target, {0.5f, 0.25f, 0.0f}), 1e-4f);
    // Half of the picture's height, at the square.
    EXPECT_NEAR(distance * std::tan(glm::radians(0.5f * mesh.camera->fov_degrees)), 2.0f, 1e-3f);
    EXPECT_THAT(mesh.notes, testing::Contains(testing::HasSubstr("is orthographic")));
}

/// A square with a node that has a light.
Model square_with_light(const Json& light) {
    Model model = square();
    model.json["extensionsUsed"] = {"KHR_lights_punctual"};
    model.json["extensions"]["KHR_lights_punctual"]["lights"] = {light};
    const std::size_t node = model.json["nodes"].size();
    model.json["nodes"].push_back({{"translation", {1, 2, 3}},
                                   {"rotation", {std::sqrt(0.5), 0, 0, -std::sqrt(0.5)}},
                                   {"scale", {7, 7, 7}},
                                   {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    model.json["scenes"][0]["nodes"].push_back(node);
    return model;
}

TEST_F(GltfTest, LightsStandAtTheirNodes) {
    const Json spot = {
        {"type", "spot"},       {"name", "lamp"},
        {"color", {1, 0.5, 0}}, {"intensity", 20},
        {"range", 9},           {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.5}}}};
    const TriangleMesh mesh = gltf(square_with_light(spot).embedded());
    EXPECT_THAT(mesh.warnings, testing::IsEmpty());
    ASSERT_EQ(mesh.lights.size(), 1u);
    PunctualLight light = mesh.lights[0];
    // -Z of the node looks down.
    EXPECT_LT(glm::distance(light.direction, glm::vec3(0, -1, 0)), 1e-6f);
    EXPECT_LT(glm::distance(light.up, glm::vec3(0, 0, -1)), 1e-6f);
    light.direction = {0, -1, 0};
    light.up = {0, 0, -1};
    EXPECT_EQ(light, (PunctualLight{.name = "lamp",
                                    .kind = PunctualLight::Kind::Spot,
                                    .intensity = {20, 10, 0},
                                    .position = {1, 2, 3},
                                    .direction = {0, -1, 0},
                                    .range = 9,
                                    .inner_cone = 0.25f,
                                    .outer_cone = 0.5f,
                                    .up = {0, 0, -1}}));
    const TriangleMesh sun = gltf(square_with_light({{"type", "directional"}}).embedded());
    EXPECT_EQ(sun.lights.at(0).name, "light 0");
    EXPECT_EQ(sun.lights[0].intensity, glm::vec3(1.0f));
    EXPECT_TRUE(std::isinf(sun.lights[0].range));
}

constexpr const char* SmallProfile = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 2 2 1 1 2 0 0 0\n1 1 5\n"
                                     "0 90\n0\n30 0\n";

/// A square, and a node of EXT_lights_ies that says `own` of the light.
Model square_with_profile(const Json& profile, const Json& own = {{"light", 0}}) {
    Model model = square();
    model.json["extensionsUsed"] = model.json["extensionsRequired"] = {"EXT_lights_ies"};
    model.json["extensions"]["EXT_lights_ies"]["lights"] = {profile};
    const std::size_t node = model.json["nodes"].size();
    model.json["nodes"].push_back({{"translation", {1, 2, 3}},
                                   {"rotation", {std::sqrt(0.5), 0, 0, -std::sqrt(0.5)}},
                                   {"scale", {7, 7, 7}},
                                   {"extensions", {{"EXT_lights_ies", own}}}});
    model.json["scenes"][0]["nodes"].push_back(node);
    return model;
}

TEST_F(GltfTest, LightsWithProfilesStandAtTheirNodes) {
    const std::string path = "data:application/x-ies-lm-63;base64," + base64(SmallProfile);
    const Json own = {{"light", 0}, {"multiplier", 4}, {"color", {1, 0.5, 0}}};
    const TriangleMesh mesh =
        gltf(square_with_profile({{"uri", path}, {"name", "lamp"}}, own).embedded());
    EXPECT_THAT(mesh.warnings, testing::IsEmpty());
    EXPECT_THAT(mesh.notes, testing::Contains("profile 0 has 137 lumen, at most 60 candela"));
    ASSERT_EQ(mesh.lights.size(), 1u);
    const PunctualLight& light = mesh.lights[0];
    EXPECT_EQ(light.name, "lamp");
    EXPECT_EQ(light.kind, PunctualLight::Kind::Profile);
    EXPECT_EQ(light.intensity, glm::vec3(4, 2, 0));
    EXPECT_EQ(light.position, glm::vec3(1, 2, 3));
    // -Z of the node, vertical 0, looks down; +X, horizontal 0, stays, and +Y looks to -Z.
    EXPECT_LT(glm::distance(light.direction, glm::vec3(0, -1, 0)), 1e-6f);
    EXPECT_LT(glm::distance(light.right, glm::vec3(1, 0, 0)), 1e-6f);
    EXPECT_LT(glm::distance(light.up, glm::vec3(0, 0, -1)), 1e-6f);
    EXPECT_EQ(light.profile.at(0.0, 0.0), 60.0);

    Model in_buffer = square_with_profile({{"mimeType", "application/x-ies-lm-63"}});
    in_buffer.json["extensions"]["EXT_lights_ies"]["lights"][0]["bufferView"] =
        in_buffer.add_view(SmallProfile);
    const TriangleMesh second = gltf(in_buffer.embedded());
    ASSERT_EQ(second.lights.size(), 1u);
    EXPECT_EQ(second.lights[0].profile, light.profile);
    EXPECT_EQ(second.lights[0].intensity, glm::vec3(1.0f));
    EXPECT_EQ(second.lights[0].name, "light 0");

    static_cast<void>(write("lamp.ies", SmallProfile));
    const LoadedMesh third =
        load(write("a.gltf", square_with_profile({{"uri", "lamp.ies"}}).embedded()));
    ASSERT_EQ(third.lights.size(), 1u);
    EXPECT_EQ(third.lights[0].profile, light.profile);
    EXPECT_THAT(third.notes, testing::Contains(testing::HasSubstr("'lamp.ies' has 137 lumen")));
}

TEST_F(GltfTest, MirroredNodesMirrorProfiles) {
    const std::string path = "data:;base64," + base64(SmallProfile);
    Model model = square_with_profile({{"uri", path}});
    model.json["nodes"].back()["scale"] = {1, -2, 1};
    const TriangleMesh mesh = gltf(model.embedded());
    ASSERT_EQ(mesh.lights.size(), 1u);
    EXPECT_LT(glm::distance(mesh.lights[0].up, glm::vec3(0, 0, 1)), 1e-6f);
    EXPECT_LT(glm::distance(mesh.lights[0].right, glm::vec3(1, 0, 0)), 1e-6f);
    // A flat one still has axes.
    model.json["nodes"].back()["scale"] = {0, 1, 1};
    const PunctualLight flat = gltf(model.embedded()).lights.at(0);
    EXPECT_NEAR(glm::length(flat.right), 1.0f, 1e-6f);
    EXPECT_NEAR(glm::dot(flat.right, flat.direction), 0.0f, 1e-6f);
    EXPECT_NEAR(glm::dot(flat.right, flat.up), 0.0f, 1e-6f);
}

TEST_F(GltfTest, BrokenProfilesCostTheirLight) {
    const auto warnings = [](const Model& model) {
        const TriangleMesh mesh = gltf(model.embedded());
        EXPECT_THAT(mesh.lights, testing::IsEmpty());
        return mesh.warnings;
    };
    EXPECT_THAT(
        warnings(square_with_profile({{"uri", "none.ies"}})),
        ElementsAre("a light is left out: expected the file 'none.ies' beside it, got none"));
    EXPECT_THAT(
        warnings(square_with_profile({{"uri", "data:;base64," + base64("TILT=NONE\n1")}})),
        ElementsAre("a light is left out: profile 0: expected lumens of a lamp in line 2, got "
                    "the end of the file"));
    EXPECT_THAT(warnings(square_with_profile({{"uri", "none.ies"}}, {{"light", 1}})),
                ElementsAre("a light is left out: expected indices of lights below 1, got 1"));
    EXPECT_THAT(warnings(square_with_profile({{"bufferView", 99}})),
                ElementsAre(testing::StartsWith("a light is left out: profile 0: ")));
}

TEST_F(GltfTest, VariantsOfMaterials) {
    Model model = square();
    model.json["extensionsUsed"] = model.json["extensionsRequired"] = {"KHR_materials_variants"};
    model.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "red"}},
                                                                      {{"name", "blue"}}};
    model.json["materials"] = {{{"name", "plain"}}, {{"name", "a"}}, {{"name", "b"}}};
    Json& primitives = model.json["meshes"][0]["primitives"];
    primitives[0]["material"] = 0;
    primitives.push_back(primitives[0]); // knows red alone
    primitives.push_back(primitives[0]); // knows none
    const auto mappings = [](const Json& all) {
        return Json{{"KHR_materials_variants", {{"mappings", all}}}};
    };
    primitives[0]["extensions"] =
        mappings({{{"material", 2}, {"variants", {1}}}, {{"material", 1}, {"variants", {0}}}});
    primitives[1]["extensions"] = mappings(Json::array({{{"material", 1}, {"variants", {0}}}}));
    const auto path = write("a.gltf", model.embedded());
    const auto materials = [&](const std::optional<std::string>& variant) {
        const LoadedMesh mesh = load(path, {.variant = variant});
        EXPECT_THAT(mesh.variants, ElementsAre("red", "blue"));
        EXPECT_EQ(mesh.warnings.size(), variant ? 0u : 1u);
        return mesh.triangle_materials;
    };
    EXPECT_THAT(materials({}), ElementsAre(0, 0, 0, 0, 0, 0));
    EXPECT_THAT(materials("red"), ElementsAre(1, 1, 1, 1, 0, 0));
    EXPECT_THAT(materials("blue"), ElementsAre(2, 2, 0, 0, 0, 0));
    expect_refusal([&] { return load(path, {.variant = "green"}); },
                   "a.gltf: expected a variant of the file ('red', 'blue'), got 'green'");
    EXPECT_THAT(load(path).warnings,
                ElementsAre("2 variants of materials: surfaces have their own; --variant NAME "
                            "chooses one, info lists them"));
    primitives[0]["extensions"] = mappings(Json::array({{{"material", 3}, {"variants", {0}}}}));
    const auto broken = write("b.gltf", model.embedded());
    expect_refusal([&] { return load(broken, {.variant = "red"}); },
                   "indices of \"materials\" below 3, got 3");
    expect_refusal([&] { return load(write("c.gltf", square().embedded()), {.variant = "red"}); },
                   "expected a variant of the file (which has none), got 'red'");
    expect_refusal([&] { return load(write("d.ply", box_ply()), {.variant = "red"}); },
                   "expected .glb or .gltf for a variant, got '.ply'");
}

/// The square, a second one with a child, and a light below that child.
Model hidden_squares() {
    Model model = square_with_light({{"type", "point"}});
    model.json["nodes"].push_back({{"mesh", 0}, {"translation", {0, 5, 0}}, {"children", {3}}});
    model.json["nodes"].push_back({{"mesh", 0}, {"translation", {0, 0, 7}}, {"children", {1}}});
    model.json["scenes"][0]["nodes"] = {0, 2};
    model.json["extensionsUsed"].push_back("KHR_node_visibility");
    return model;
}

TEST_F(GltfTest, HiddenNodesAreNotThere) {
    Model model = hidden_squares();
    EXPECT_EQ(gltf(model.embedded()).num_vertices(), 12u);
    Json& visibility = model.json["nodes"][2]["extensions"]["KHR_node_visibility"];
    visibility = Json::object();
    EXPECT_EQ(gltf(model.embedded()).num_vertices(), 12u) << "visible unless it says otherwise";
    visibility["visible"] = false;
    const TriangleMesh mesh = gltf(model.embedded());
    EXPECT_EQ(mesh.num_vertices(), 4u) << "what is below a hidden node is hidden, too";
    EXPECT_THAT(mesh.lights, testing::IsEmpty());
    EXPECT_THAT(mesh.warnings, testing::IsEmpty());
    EXPECT_THAT(mesh.notes,
                testing::Contains("3 hidden nodes (KHR_node_visibility): neither drawn, nor "
                                  "shadow, nor light"));
    visibility["visible"] = 0;
    expect_refusal([&] { return gltf(model.embedded()); }, "true or false as \"visible\", got '0'");
}

// Its exporter writes 683 lumens for a watt of a light, and emission as radiance.
TEST_F(GltfTest, LightsOfBlenderAreAsBrightBesideEmissionAsInBlender) {
    Model model = square_with_light({{"type", "point"}, {"intensity", 683.0 * 3.0}});
    model.json["asset"]["generator"] = "Khronos glTF Blender I/O v4.2.57";
    const TriangleMesh mesh = gltf(model.embedded());
    EXPECT_FLOAT_EQ(mesh.lights.at(0).intensity.x, 3.0f);
    EXPECT_THAT(mesh.warnings, testing::ElementsAre(testing::HasSubstr("divided by 683")));

    Model dark = square();
    dark.json["asset"]["generator"] = "Khronos glTF Blender I/O v4.2.57";
    EXPECT_THAT(gltf(dark.embedded()).warnings, testing::IsEmpty());
    model.json["asset"]["generator"] = "COLLADA2GLTF";
    EXPECT_FLOAT_EQ(gltf(model.embedded()).lights.at(0).intensity.x, 683.0f * 3.0f);
}

TEST_F(GltfTest, LightsOutOfRangeAreBroughtIntoIt) {
    const auto read = [](const Json& light, const std::string& warning) {
        const TriangleMesh mesh = gltf(square_with_light(light).embedded());
        EXPECT_THAT(mesh.warnings, testing::ElementsAre(testing::HasSubstr(warning)));
        return mesh.lights.at(0);
    };
    EXPECT_EQ(read({{"type", "point"}, {"intensity", -1}}, "as \"intensity\", got -1").intensity,
              glm::vec3(0.0f));
    EXPECT_EQ(
        read({{"type", "point"}, {"color", {1, 1.2, 0.5}}}, "as \"color\", got 1.2").intensity,
        glm::vec3(1.0f, 1.0f, 0.5f));
    EXPECT_TRUE(std::isinf(
        read({{"type", "point"}, {"range", 0}}, "more than 0 as \"range\", got 0").range));
    const PunctualLight sharp =
        read({{"type", "spot"}, {"spot", {{"innerConeAngle", 0.5}, {"outerConeAngle", 0.5}}}},
             "as \"innerConeAngle\", got 0.5");
    EXPECT_LT(sharp.inner_cone, sharp.outer_cone);
    EXPECT_FLOAT_EQ(
        read({{"type", "spot"}, {"spot", {{"outerConeAngle", 3}}}}, "\"outerConeAngle\"")
            .outer_cone,
        std::numbers::pi_v<float> / 2);
}

TEST_F(GltfTest, LightsThatCannotBeAreLeftOut) {
    Model model = square_with_light({{"type", "point"}});
    model.json["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = 4;
    for (const Model& broken : {square_with_light({{"type", "area"}}), model}) {
        const TriangleMesh mesh = gltf(broken.embedded());
        EXPECT_TRUE(mesh.lights.empty());
        EXPECT_THAT(mesh.warnings,
                    testing::ElementsAre(testing::StartsWith("a light is left out: ")));
    }
}

} // namespace
} // namespace relumine::mesh
