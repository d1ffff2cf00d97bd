// glTF and GLB: geometry, transforms, materials and textures as written; broken files.
#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

#include "mesh/save.h"
#include "tests/mesh/mesh_files.h"
#include "tests/mesh/texture_files.h"

namespace relumine::mesh {
namespace {

using Json = nlohmann::json;
using testing::ElementsAre;

std::string base64(const std::string& bytes) {
    constexpr std::string_view Alphabet =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t j = 0; j < 3; ++j)
            bits =
                bits << 8u | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0u);
        for (std::size_t j = 0; j < 4; ++j)
            text += i + j > bytes.size() ? '=' : Alphabet[bits >> (18 - 6 * j) & 63u];
    }
    return text;
}

/// A model under construction: JSON and one buffer.
struct Model {
    Json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}};
    std::string buffer;

    std::size_t add_view(const std::string& bytes, std::size_t stride = 0) {
        buffer.resize((buffer.size() + 3) / 4 * 4);
        Json view = {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}};
        if (stride > 0)
            view["byteStride"] = stride;
        buffer += bytes;
        json["bufferViews"].push_back(view);
        return json["bufferViews"].size() - 1;
    }
    template<class Value>
    std::size_t add(const std::vector<Value>& values, int component_type, const char* type,
                    bool normalized = false, std::size_t count = 0) {
        const std::string bytes(reinterpret_cast<const char*>(values.data()),
                                values.size() * sizeof(Value));
        json["accessors"].push_back({{"bufferView", add_view(bytes)},
                                     {"componentType", component_type},
                                     {"type", type},
                                     {"normalized", normalized},
                                     {"count", count == 0 ? values.size() : count}});
        return json["accessors"].size() - 1;
    }
    [[nodiscard]] std::string embedded() const {
        Json copy = json;
        copy["buffers"] = {{{"byteLength", buffer.size()},
                            {"uri", "data:application/octet-stream;base64," + base64(buffer)}}};
        return copy.dump();
    }
    [[nodiscard]] std::string external(const std::string& uri) const {
        Json copy = json;
        copy["buffers"] = {{{"byteLength", buffer.size()}, {"uri", uri}}};
        return copy.dump();
    }
    [[nodiscard]] std::string glb() const {
        Json copy = json;
        copy["buffers"] = {{{"byteLength", buffer.size()}}};
        std::string text = copy.dump(), binary = buffer;
        text.resize((text.size() + 3) / 4 * 4, ' ');
        binary.resize((binary.size() + 3) / 4 * 4, '\0');
        std::string file = "glTF";
        const auto word = [&file](std::size_t value) {
            const auto number = static_cast<std::uint32_t>(value);
            file.append(reinterpret_cast<const char*>(&number), 4);
        };
        word(2), word(12 + 8 + text.size() + 8 + binary.size());
        word(text.size()), word(0x4E4F534Au), file += text;
        word(binary.size()), word(0x004E4942u), file += binary;
        return file;
    }
};

/// A square in the plane z = 0 with uvs, two triangles, one node.
Model square() {
    Model model;
    const auto positions =
        model.add<glm::vec3>({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 5126, "VEC3");
    const auto uvs = model.add<glm::vec2>({{0, 1}, {1, 1}, {1, 0}, {0, 0}}, 5126, "VEC2");
    const auto indices = model.add<std::uint16_t>({0, 1, 2, 0, 2, 3}, 5123, "SCALAR");
    model.json["meshes"] = {{{"name", "square"},
                             {"primitives",
                              {{{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}},
                                {"indices", indices}}}}}};
    model.json["nodes"] = {{{"mesh", 0}}};
    return model;
}

TriangleMesh gltf(const std::string& file) {
    return to_mesh(read_gltf(bytes_of(file), {}), NormalSource::File);
}

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
                                                          .times_vertex_color = true}}));
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
    save(folder_ / "box.glb", box, radiance);
    const TriangleMesh loaded = load(folder_ / "box.glb");
    expect_box(loaded);
    EXPECT_EQ(loaded.colors, radiance);
    EXPECT_EQ(loaded.materials, (std::vector<Material>{{.name = "radiance"}}))
        << "unlit is no metal";
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
    const TriangleMesh mesh = gltf(model.embedded());
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
                                           .times_vertex_color = true}));
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
    expect_refusal([&] { return gltf(model.embedded()); }, "material 0: expected one texCoord");
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
    refused([](Json& j) { j["extensionsRequired"] = {"KHR_draco_mesh_compression"}; },
            "KHR_draco_mesh_compression");
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
    refused([](Json& j) { j["accessors"][0]["type"] = "MAT4"; }, "MAT4");
    refused([](Json& j) { j["accessors"][0]["componentType"] = 5130; }, "5130");
    refused([](Json& j) { j["accessors"][0]["sparse"] = Json::object(); }, "sparse");
    refused([](Json& j) { j["accessors"][0].erase("bufferView"); }, "zero");
    refused([](Json& j) { j["accessors"][1]["count"] = 3; }, "4 elements of TEXCOORD_0");
    refused([](Json& j) { j["accessors"][2]["componentType"] = 5126; }, "accessor 2");
    refused([](Json& j) { j["accessors"][2]["componentType"] = 5122; }, "unsigned integers");
    refused([](Json& j) { j["accessors"][2]["count"] = 5; }, "a multiple of 3");
    refused(
        [](Json& j) {
            j["accessors"][2].update({{"bufferView", 0}, {"byteOffset", 12}});
        },
        "vertex indices below 4, got 16256");
    refused([](Json& j) { j["bufferViews"][0]["byteLength"] = 4096; }, "buffer view 0 inside");
    refused([](Json& j) { j["bufferViews"][0]["byteOffset"] = 1e12; }, "buffer view 0 inside");
    refused([](Json& j) { j["bufferViews"][0]["byteStride"] = 4; }, "byteStride of 12");
    refused([](Json& j) { j["meshes"][0]["primitives"][0]["material"] = 0; },
            "indices of \"materials\" below 0");
    refused([](Json& j) { j["meshes"][0]["primitives"][0]["mode"] = 9; }, "mode");
    refused([](Json& j) { j["meshes"] = 3; }, "\"meshes\"");
    refused(
        [](Json& j) {
            j["materials"] = {{{"pbrMetallicRoughness", {{"roughnessFactor", 2}}}}};
        },
        "material 0: expected a number of 0 to 1 as \"roughnessFactor\"");
    refused(
        [](Json& j) {
            j["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1}}}}}};
        },
        "4 numbers");
    refused(
        [](Json& j) {
            j["images"] = {{{"uri", "data:image/png;base64,AAAA"}}};
            j["textures"] = {{{"source", 0}}};
            j["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
        },
        "image 0: expected a PNG");
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
    EXPECT_EQ(gltf(repeated(50, 500)).num_vertices(), 4u * 50 * 500);
    expect_refusal([&] { return gltf(repeated(2000, 1000)); }, "vertices and triangles of");
}

TEST_F(GltfTest, DeepFilesAreRefusedOrRead) {
    std::string deep(200000, '[');
    deep += std::string(200000, ']');
    expect_refusal([&] { return gltf("{\"asset\":{\"version\":" + deep + "}}"); },
                   "text as \"version\", got array");
    Model model = square();
    for (std::size_t i = 1; i < 20000; ++i) {
        model.json["nodes"].push_back({{"mesh", 0}});
        model.json["nodes"][i - 1] = {{"children", {i}}};
    }
    EXPECT_EQ(gltf(model.embedded()).num_vertices(), 4u);
}

} // namespace
} // namespace relumine::mesh
