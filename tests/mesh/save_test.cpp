#include "mesh/save.h"

#include <cstring>
#include <limits>
#include <span>
#include <string>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "files/output_file.h"
#include "tests/mesh/lit_ply.h"
#include "tests/mesh/mesh_files.h"
#include "tests/mesh/texture_files.h"

namespace relumine::mesh {
namespace {

class SaveTest : public MeshFileTest {
protected:
    [[nodiscard]] std::size_t num_files() const {
        return static_cast<std::size_t>(
            std::distance(std::filesystem::directory_iterator(folder_), {}));
    }
    const TriangleMesh box_ = ply(box_ply());
    const std::vector<glm::vec3> radiance_ = {{0, 0, 0},     {1, 0, 0},           {0, 100.5f, 0},
                                              {0, 0, 1e-6f}, {1, 0.1f, 1},        {2, 2, 2},
                                              {3, 3, 3},     {0.25f, 0.5f, 0.75f}};
};

TEST_F(SaveTest, PlyLoadsAgainUnchanged) {
    TriangleMesh mesh = box_;
    mesh.colors = radiance_;
    save(folder_ / "box.ply", mesh);
    const TriangleMesh loaded = load(folder_ / "box.ply");
    EXPECT_EQ(loaded.positions, box_.positions);
    EXPECT_EQ(loaded.triangles, box_.triangles);
    EXPECT_EQ(loaded.colors, radiance_) << "floats, beyond 1 as well";
    for (std::size_t i = 0; i < loaded.num_vertices(); ++i)
        EXPECT_NEAR(glm::distance(loaded.normals[i], box_.normals[i]), 0.0f, 1e-6f);
    EXPECT_EQ(num_files(), 1u);
}

TEST_F(SaveTest, LitPlyHoldsWhatViewersShowAndTheRadiance) {
    save_lit(folder_ / "box.ply", box_, radiance_);
    EXPECT_EQ(load(folder_ / "box.ply").triangles, box_.triangles);
    EXPECT_EQ(load(folder_ / "box.ply").colors, radiance_);

    const std::vector<LitVertex> vertices = lit_ply(folder_ / "box.ply", 8);
    for (std::size_t i = 0; i < 8; ++i)
        EXPECT_EQ(vertices[i].radiance, radiance_[i]);
    EXPECT_THAT(vertices[2].shown, testing::ElementsAre(0, 255, 0)) << "100.5";
    EXPECT_THAT(vertices[7].shown, testing::ElementsAre(137, 188, 225)) << "the curve of sRGB";
}

/// A .glb file's JSON and its bytes, read by the format's own words and not by Relumine's reader.
struct Glb {
    nlohmann::json document;
    std::vector<std::byte> bytes;

    [[nodiscard]] const nlohmann::json& accessor(const nlohmann::json& index) const {
        return document.at("accessors").at(index.get<std::size_t>());
    }
    /// The values of an accessor, which must fill its buffer view.
    template<class Value>
    [[nodiscard]] std::vector<Value> values(const nlohmann::json& index) const {
        const nlohmann::json& of = accessor(index);
        const nlohmann::json& view =
            document.at("bufferViews").at(of.at("bufferView").get<std::size_t>());
        EXPECT_EQ(view.at("buffer"), 0);
        const auto offset = view.value("byteOffset", std::size_t{0});
        const std::size_t scalars = sizeof(Value) / 4;
        std::vector<Value> values(of.at("count").get<std::size_t>());
        EXPECT_EQ(of.at("type"), scalars == 3 ? "VEC3" : "SCALAR");
        EXPECT_EQ(view.at("byteLength"), values.size() * sizeof(Value));
        EXPECT_EQ(offset % 4, 0u);
        if (offset + values.size() * sizeof(Value) > bytes.size())
            throw std::out_of_range("a view ends behind the bytes");
        std::memcpy(values.data(), bytes.data() + offset, values.size() * sizeof(Value));
        return values;
    }
};

Glb read_glb(const std::filesystem::path& path) {
    const std::vector<std::byte> file = files::read(path);
    const auto number = [&](std::size_t offset) {
        std::uint32_t value = 0;
        std::memcpy(&value, &file.at(offset + 3) - 3, sizeof value);
        return value;
    };
    EXPECT_EQ(std::memcmp(file.data(), "glTF", 4), 0);
    EXPECT_EQ(number(4), 2u) << "version";
    EXPECT_EQ(number(8), file.size());
    const std::size_t json_size = number(12);
    EXPECT_EQ(json_size % 4, 0u);
    EXPECT_EQ(number(16), 0x4e4f534au) << "JSON";
    const auto json = reinterpret_cast<const char*>(&file.at(20));
    const std::size_t bytes_at = 20 + json_size;
    EXPECT_EQ(number(bytes_at) % 4, 0u);
    EXPECT_EQ(number(bytes_at + 4), 0x004e4942u) << "BIN";
    EXPECT_EQ(bytes_at + 8 + number(bytes_at), file.size()) << "nothing follows";
    Glb glb{.document = nlohmann::json::parse(json, json + json_size),
            .bytes = {file.begin() + static_cast<std::ptrdiff_t>(bytes_at + 8), file.end()}};
    EXPECT_EQ(glb.document.at("buffers").size(), 1u);
    EXPECT_EQ(glb.document.at("buffers").at(0).at("byteLength"), glb.bytes.size());
    return glb;
}

TEST_F(SaveTest, GlbHoldsWhatItShould) {
    TriangleMesh mesh = box_;
    mesh.normals[3] = glm::vec3(0.0f);
    save_lit(folder_ / "box.GLB", mesh, radiance_);
    EXPECT_EQ(num_files(), 1u);

    const Glb glb = read_glb(folder_ / "box.GLB");
    const nlohmann::json& document = glb.document;
    EXPECT_EQ(document.at("asset").at("version"), "2.0");
    EXPECT_EQ(document.at("extensionsUsed"), nlohmann::json::array({"KHR_materials_unlit"}));
    EXPECT_EQ(document.at("scenes").at(document.at("scene").get<std::size_t>()).at("nodes"),
              nlohmann::json::array({0}));
    EXPECT_EQ(document.at("nodes").at(0).at("mesh"), 0);
    const nlohmann::json& primitive = document.at("meshes").at(0).at("primitives").at(0);
    EXPECT_EQ(primitive.at("mode"), 4) << "triangles";
    EXPECT_EQ(document.at("materials")
                  .at(primitive.at("material").get<std::size_t>())
                  .at("extensions")
                  .count("KHR_materials_unlit"),
              1u);

    constexpr int Float = 5126, UnsignedInt = 5125;
    const nlohmann::json& attributes = primitive.at("attributes");
    const nlohmann::json& position = glb.accessor(attributes.at("POSITION"));
    EXPECT_EQ(position.at("min"), (std::vector<double>{0, 0, 0}));
    EXPECT_EQ(position.at("max"), (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(glb.values<glm::vec3>(attributes.at("POSITION")), mesh.positions);
    const nlohmann::json& color = attributes.at("COLOR_0");
    EXPECT_EQ(glb.accessor(color).at("componentType"), Float);
    EXPECT_EQ(glb.accessor(color).at("type"), "VEC3");
    std::vector<glm::vec3> shown = radiance_;
    for (glm::vec3& value : shown)
        value = glm::min(value, 1.0f);
    EXPECT_EQ(glb.values<glm::vec3>(color), shown) << "glTF's colours end at 1";
    EXPECT_EQ(glb.values<glm::vec3>(attributes.at("_RADIANCE")), radiance_);
    for (const glm::vec3& normal : glb.values<glm::vec3>(attributes.at("NORMAL")))
        EXPECT_NEAR(glm::length(normal), 1.0f, 1e-5f) << "glTF knows no zero normals";
    EXPECT_EQ(glb.accessor(primitive.at("indices")).at("componentType"), UnsignedInt);
    std::vector<std::uint32_t> expected;
    for (const Triangle& triangle : mesh.triangles)
        expected.insert(expected.end(), triangle.begin(), triangle.end());
    EXPECT_EQ(glb.values<std::uint32_t>(primitive.at("indices")), expected);
}

TEST_F(SaveTest, FailingLeavesNothingBehind) {
    for (const char* name : {"box.ply", "box.glb"}) {
        const std::filesystem::path target = write(name, "old");
        std::vector<glm::vec3> bad = radiance_;
        bad[5].y = std::numeric_limits<float>::quiet_NaN();
        expect_refusal([&] { return save_lit(target, box_, bad), 0; },
                       "finite colours, got 2 nan 2 at vertex 5");
        bad.pop_back();
        expect_refusal([&] { return save_lit(target, box_, bad), 0; }, "expected 8 colours, got 7");
        expect_refusal([&] { return save_lit(target, TriangleMesh{}, {}), 0; }, "triangles");
        EXPECT_EQ(files::read(target).size(), 3u);
        EXPECT_THROW(save_lit(folder_ / "missing" / name, box_, radiance_), std::runtime_error);
    }
    expect_refusal([&] { return save_lit(folder_ / "box.obj", box_, radiance_), 0; },
                   ".ply or .glb");
    EXPECT_EQ(num_files(), 2u);
}

TEST_F(SaveTest, AMeshAsItIsLoadsAgainFromGlb) {
    TriangleMesh mesh = box_;
    mesh.colors = {{0, 0, 0},    {1, 0, 0}, {0, 0.5f, 0}, {0, 0, 0.25f},
                   {1, 0.5f, 1}, {1, 1, 1}, {1, 1, 0},    {0.25f, 0.5f, 0.75f}};
    EXPECT_TRUE(save(folder_ / "box.glb", mesh).empty());
    const TriangleMesh loaded = load(folder_ / "box.glb");
    EXPECT_EQ(loaded.positions, mesh.positions);
    EXPECT_EQ(loaded.triangles, mesh.triangles);
    EXPECT_EQ(loaded.normals, mesh.normals);
    EXPECT_EQ(loaded.colors, mesh.colors);

    // With materials, a primitive each.
    mesh.materials = {{.name = "unused"},
                      {.name = "red", .base_color = {0.5f, 0.25f, 0.125f}},
                      {.name = "metal",
                       .model = MaterialModel::MetallicRoughness,
                       .metallic = 1.0f,
                       .roughness = 0.5f}};
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i)
        mesh.triangle_materials.push_back(i % 3 == 0 ? 2 : 1);
    mesh.triangle_groups.assign(mesh.num_triangles(), 0);
    mesh.groups = {"box"};
    mesh.uvs.assign(mesh.num_vertices(), glm::vec2(0.5f));
    EXPECT_TRUE(save(folder_ / "box.glb", mesh).empty());
    const TriangleMesh parts = load(folder_ / "box.glb");
    ASSERT_EQ(parts.num_triangles(), mesh.num_triangles());
    EXPECT_EQ(parts.groups, mesh.groups);
    std::size_t num_metal = 0;
    for (std::size_t i = 0; i < parts.num_triangles(); ++i) {
        const Material& material = parts.materials[parts.triangle_materials[i]];
        num_metal += material.name == "metal" ? 1 : 0;
        if (material.name == "metal") {
            EXPECT_EQ(material.roughness, 0.5f);
            EXPECT_EQ(material.metallic, 1.0f);
        } else {
            EXPECT_EQ(material.base_color, glm::vec3(0.5f, 0.25f, 0.125f));
        }
    }
    EXPECT_EQ(num_metal, (mesh.num_triangles() + 2) / 3);
    EXPECT_THROW(save(folder_ / "none.glb", TriangleMesh()), std::runtime_error);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "none.glb"));
}

/// A texture of bytes that need not be decoded here.
Texture texture_of(const std::string& file, VOrigin origin) {
    ImageBudget budget;
    return decode_texture(std::as_bytes(std::span(file)), origin, budget);
}

TEST_F(SaveTest, GlbKeepsTexturesAndBothUvs) {
    TriangleMesh mesh = box_;
    mesh.textures = {texture_of(four_colors(), VOrigin::Top),
                     texture_of(png(1, 1, {Red}), VOrigin::Top)};
    const TextureSlot plain{.texture = 0, .is_srgb = true, .wrap = {Wrap::Clamp, Wrap::Mirror}};
    TextureSlot turned{.texture = 1, .uv_set = 1, .uv_offset = {0.25f, -0.5f}};
    turned.uv_from_mesh_uv = glm::mat2(0.0f, -2.0f, 0.5f, 0.0f); // a quarter turn
    TextureSlot mirrored{.texture = 0, .is_srgb = true, .uv_set = 1};
    mirrored.uv_from_mesh_uv = glm::mat2(-1.0f, 0.0f, 0.0f, 3.0f);
    mesh.materials = {{.name = "all",
                       .model = MaterialModel::MetallicRoughness,
                       .times_vertex_color = true,
                       .base_color_texture = plain,
                       .metallic_roughness_texture = turned,
                       .emission = {0.5f, 0.25f, 1.0f},
                       .emission_texture = mirrored,
                       .alpha_mode = AlphaMode::Mask,
                       .alpha = 0.75f,
                       .alpha_cutoff = 0.25f,
                       .normal_texture = turned,
                       .normal_scale = 0.5f,
                       .coat = 0.5f,
                       .coat_roughness_texture = turned}};
    mesh.triangle_materials.assign(mesh.num_triangles(), 0);
    for (std::size_t i = 0; i < mesh.num_vertices(); ++i) {
        mesh.uvs.emplace_back(0.125f * static_cast<float>(i), 1.5f);
        mesh.second_uvs.emplace_back(0.5f, -0.25f * static_cast<float>(i));
    }
    EXPECT_TRUE(save(folder_ / "box.glb", mesh).empty());
    const TriangleMesh loaded = load(folder_ / "box.glb");
    EXPECT_EQ(loaded.uvs, mesh.uvs);
    EXPECT_EQ(loaded.second_uvs, mesh.second_uvs);
    ASSERT_EQ(loaded.textures.size(), 2u) << "each image once";
    for (std::size_t i = 0; i < 2; ++i)
        EXPECT_EQ(loaded.textures[i].texels, mesh.textures[i].texels);
    const Material &own = loaded.materials.at(0), &expected = mesh.materials[0];
    EXPECT_EQ(own.base_color_texture, expected.base_color_texture);
    for (const auto slot : {&Material::metallic_roughness_texture, &Material::emission_texture,
                            &Material::normal_texture, &Material::coat_roughness_texture}) {
        ASSERT_TRUE(own.*slot);
        for (const glm::vec2& uv : {glm::vec2(0.25f, 0.5f), glm::vec2(1.0f, 0.0f)}) {
            const auto place = [&](const TextureSlot& by) {
                return by.uv_from_mesh_uv * uv + by.uv_offset;
            };
            EXPECT_LT(glm::distance(place(*(own.*slot)), place(*(expected.*slot))), 1e-6f);
        }
        EXPECT_EQ((own.*slot)->uv_set, (expected.*slot)->uv_set);
        EXPECT_EQ((own.*slot)->texture, (expected.*slot)->texture);
    }
    EXPECT_EQ(own.alpha_mode, AlphaMode::Mask);
    EXPECT_EQ(own.alpha, 0.75f);
    EXPECT_EQ(own.alpha_cutoff, 0.25f);
    EXPECT_EQ(own.normal_scale, 0.5f);
}

/// Two groups of two materials, whose uvs count from below and have a seam.
TEST_F(SaveTest, AnObjBecomesAGlbThatLooksTheSame) {
    static_cast<void>(write("four.png", four_colors()));
    static_cast<void>(write("a.mtl", "newmtl paint\n"
                                     "map_Kd -s 2 0.5 1 -o 0.125 0.25 0 four.png\n"
                                     "newmtl plain\n"));
    const auto file =
        write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                       "vt 0.1 0.2\nvt 0.4 0.2\nvt 0.4 0.9\nvt 0.1 0.9\nvt 0.7 0.7\n"
                       "g one\nusemtl paint\nf 1/1 2/2 3/3\nusemtl plain\nf 1/5 3/3 4/4\n"
                       "g two\nusemtl paint\nf 4/4 3/5 2/1\n");
    const TriangleMesh mesh = load(file);
    ASSERT_FALSE(mesh.corner_uvs.empty());
    EXPECT_TRUE(save(folder_ / "a.glb", mesh).empty());
    const TriangleMesh loaded = load(folder_ / "a.glb");
    EXPECT_EQ(loaded.groups, mesh.groups);
    EXPECT_EQ(loaded.num_vertices(), 5u + 3u) << "of the first group one has two uvs";
    ASSERT_EQ(loaded.num_triangles(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(loaded.triangle_groups[i], mesh.triangle_groups[i]);
        const Material &own = loaded.materials[loaded.triangle_materials[i]],
                       &expected = mesh.materials[mesh.triangle_materials[i]];
        EXPECT_EQ(own.name, expected.name);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t vertex = loaded.triangles[i][k];
            EXPECT_EQ(loaded.positions[vertex], mesh.positions[mesh.triangles[i][k]]);
            if (expected.base_color_texture) {
                const glm::vec3 color =
                    sample(loaded.textures[0], *own.base_color_texture, loaded.uvs[vertex]);
                EXPECT_LT(
                    glm::distance(color, sample(mesh.textures[0], *expected.base_color_texture,
                                                mesh.corner_uvs[i][k])),
                    1e-4f);
            }
        }
    }
}

TEST_F(SaveTest, SaysWhichImagesAGlbCannotHave) {
    TriangleMesh mesh = box_;
    Texture made{.name = "made", .width = 1, .height = 1, .texels = {Red}};
    mesh.textures = {made, texture_of(png(1, 1, {Red}), VOrigin::Bottom)};
    mesh.textures[1].name = "rough.png";
    mesh.materials = {
        {.name = "a", .base_color_texture = TextureSlot{.texture = 0}},
        {.name = "b", .roughness_texture = TextureSlot{.texture = 1}},
        {.name = "c", .alpha_mode = AlphaMode::Mask, .alpha_texture = TextureSlot{.texture = 1}}};
    mesh.triangle_materials.assign(mesh.num_triangles(), 0);
    mesh.uvs.assign(mesh.num_vertices(), glm::vec2(0.5f));
    EXPECT_THAT(save(folder_ / "box.glb", mesh),
                testing::ElementsAre("the image made, which is no PNG, JPEG or WebP",
                                     "images of roughness or metal alone of the material b",
                                     "an image of alpha alone of the material c"));
}

TEST_F(SaveTest, GlbKeepsLayersAndGlassAndPrimitivesShareVertices) {
    TriangleMesh mesh = box_;
    Material glass{.name = "glass",
                   .model = MaterialModel::MetallicRoughness,
                   .roughness = 0.25f,
                   .transmission = 0.5f,
                   .thickness = 0.75f,
                   .attenuation_color = {0.5f, 1.0f, 0.25f},
                   .attenuation_distance = 2.0f,
                   .dispersion = 0.5f,
                   .is_double_sided = false,
                   .ior = 1.25f};
    Material layered{.name = "layered",
                     .model = MaterialModel::MetallicRoughness,
                     .is_double_sided = false,
                     .specular_strength = 0.5f,
                     .specular_tint = {1.0f, 0.5f, 2.0f},
                     .coat = 0.75f,
                     .coat_roughness = 0.125f,
                     .sheen = {0.5f, 0.25f, 1.0f},
                     .sheen_roughness = 0.5f,
                     .film = 0.5f,
                     .film_ior = 1.75f,
                     .film_thickness_at_0 = 50.0f,
                     .film_thickness_at_1 = 700.0f,
                     .anisotropy = 0.25f,
                     .anisotropy_rotation = 1.5f};
    mesh.materials = {glass, layered};
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i)
        mesh.triangle_materials.push_back(i < 4 ? 0 : 1);
    EXPECT_TRUE(save(folder_ / "box.glb", mesh).empty());
    const TriangleMesh loaded = load(folder_ / "box.glb");
    EXPECT_EQ(loaded.positions, mesh.positions) << "one array for all primitives";
    EXPECT_EQ(loaded.triangles, mesh.triangles);
    EXPECT_EQ(loaded.triangle_materials, mesh.triangle_materials);
    for (Material& material : mesh.materials)
        material.times_vertex_color = true; // as glTF says
    EXPECT_EQ(loaded.materials, mesh.materials);
}

} // namespace
} // namespace relumine::mesh
