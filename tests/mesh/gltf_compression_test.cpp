// Compressed glTF: the same mesh as without compression, and broken data.
#include "tests/mesh/encoders.h"
#include "tests/mesh/gltf_model.h"

namespace relumine::mesh {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A bent grid of n x n vertices with all attributes.
DracoSource grid(std::uint32_t n) {
    DracoSource source;
    for (std::uint32_t i = 0; i < n * n; ++i) {
        const glm::vec2 uv = glm::vec2(i % n, i / n) / static_cast<float>(n - 1);
        source.positions.emplace_back(3.0f * uv.x, uv.x * uv.y, -2.0f * uv.y);
        source.normals.push_back(glm::normalize(glm::vec3(-uv.y, 3.0f, uv.x)));
        source.uvs.push_back(uv);
        source.colors.push_back({static_cast<std::uint8_t>(i % 256), 255, 51, 128});
    }
    for (std::uint32_t y = 0; y + 1 < n; ++y)
        for (std::uint32_t x = 0; x + 1 < n; ++x) {
            const std::uint32_t a = y * n + x, b = a + 1, c = a + n, d = c + 1;
            source.triangles.push_back({a, b, d});
            source.triangles.push_back({a, d, c});
        }
    return source;
}

/// The grid in a file, compressed. Accessors have counts and types but no buffer views.
Model compressed(const DracoSource& source) {
    Model model;
    const auto view = model.add_view(draco_data(source));
    const auto accessor = [&](const char* type, int component_type, std::size_t count) {
        model.json["accessors"].push_back(
            {{"type", type}, {"componentType", component_type}, {"count", count}});
        return model.json["accessors"].size() - 1;
    };
    const std::size_t n = source.positions.size();
    Json attributes = {{"POSITION", accessor("VEC3", 5126, n)}}, ids = {{"POSITION", 7}};
    if (!source.normals.empty())
        attributes["NORMAL"] = accessor("VEC3", 5126, n), ids["NORMAL"] = 5;
    if (!source.uvs.empty())
        attributes["TEXCOORD_0"] = accessor("VEC2", 5126, n), ids["TEXCOORD_0"] = 3;
    if (!source.colors.empty()) {
        attributes["COLOR_0"] = accessor("VEC4", 5121, n), ids["COLOR_0"] = 1;
        model.json["accessors"].back()["normalized"] = true;
    }
    const auto indices = accessor("SCALAR", 5123, 3 * source.triangles.size());
    const Json extension = {{"bufferView", view}, {"attributes", ids}};
    model.json["meshes"] = {{{"primitives",
                              {{{"attributes", attributes},
                                {"indices", indices},
                                {"extensions", {{"KHR_draco_mesh_compression", extension}}}}}}}};
    model.json["nodes"] = {{{"mesh", 0}}};
    model.json["extensionsUsed"] =
        model.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    return model;
}

TEST(GltfCompression, DracoWithoutQuantisationIsExact) {
    const DracoSource source = grid(9);
    const TriangleMesh mesh = gltf(compressed(source).embedded());
    EXPECT_EQ(defect(mesh), "");
    EXPECT_EQ(mesh.positions, source.positions);
    EXPECT_EQ(mesh.uvs, source.uvs);
    EXPECT_EQ(mesh.triangles, source.triangles);
    EXPECT_THAT(mesh.warnings, ElementsAre());
    ASSERT_EQ(mesh.normals.size(), source.normals.size());
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
        EXPECT_LT(glm::distance(mesh.normals[i], source.normals[i]), 1e-6f);
        EXPECT_EQ(mesh.colors[i],
                  glm::vec3(static_cast<float>(source.colors[i][0]) / 255.0f, 1.0f, 0.2f));
    }
}

/// Edgebreaker sorts vertices; a vertex of the grid is known by its uv.
TEST(GltfCompression, DracoWithQuantisationIsWithinItsStep) {
    constexpr std::uint32_t N = 33;
    DracoSource source = grid(N);
    source.is_sequential = false;
    source.quantization_bits = 14;
    const TriangleMesh mesh = gltf(compressed(source).embedded());
    EXPECT_EQ(defect(mesh), "");
    ASSERT_EQ(mesh.num_vertices(), source.positions.size());
    ASSERT_EQ(mesh.num_triangles(), source.triangles.size());
    std::vector<bool> found(N * N, false);
    for (std::size_t i = 0; i < mesh.num_vertices(); ++i) {
        const auto at = [](float x) {
            return static_cast<std::size_t>(std::lround(x * (N - 1)));
        };
        const std::size_t from = at(mesh.uvs[i].y) * N + at(mesh.uvs[i].x);
        found[from] = true;
        EXPECT_LT(glm::distance(mesh.positions[i], source.positions[from]), 2e-4f);
        EXPECT_LT(glm::distance(mesh.normals[i], source.normals[from]), 1e-3f);
        EXPECT_EQ(mesh.colors[i].r, static_cast<float>(source.colors[from][0]) / 255.0f);
    }
    EXPECT_EQ(std::count(found.begin(), found.end(), true), N * N) << "each vertex once";
    EXPECT_NEAR(area(mesh), area(gltf(compressed(grid(N)).embedded())), 1e-3);
    for (const Triangle& t : mesh.triangles)
        EXPECT_GT(glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                             mesh.positions[t[2]] - mesh.positions[t[0]])
                      .y,
                  0.0f);
}

/// Attributes beside the Draco data are read as usual, and nodes place the mesh.
TEST(GltfCompression, DracoHoldsSomeOfTheAttributes) {
    DracoSource source = grid(3);
    const std::vector<glm::vec2> uvs = std::exchange(source.uvs, {});
    Model model = compressed(source);
    model.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] =
        model.add(uvs, 5126, "VEC2");
    model.json["nodes"][0]["translation"] = {0, 10, 0};
    const TriangleMesh mesh = gltf(model.embedded());
    EXPECT_EQ(mesh.uvs, uvs);
    EXPECT_EQ(mesh.positions[8], source.positions[8] + glm::vec3(0, 10, 0));
}

TEST(GltfCompression, DracoDataGovernWhereAccessorsDisagree) {
    Model model = compressed(grid(3));
    model.json["accessors"][0]["count"] = 7;
    const TriangleMesh mesh = gltf(model.embedded());
    EXPECT_EQ(mesh.num_vertices(), 9u);
    EXPECT_THAT(mesh.warnings,
                ElementsAre("Draco data of 9 vertices and 24 indices; the accessors say 7 and 24"));
}

TEST(GltfCompression, BrokenDracoDataAreOneLine) {
    const Model good = compressed(grid(9));
    const auto refused = [&](const auto& change, const std::string& part) {
        Model model = good;
        change(model);
        expect_refusal([&] { return gltf(model.embedded()); }, part);
    };
    const auto extension = [](Model& model) -> Json& {
        return model.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
    };
    refused([](Model& m) { m.buffer.replace(0, 5, "ocard"); }, "Draco mesh, got broken data");
    refused([](Model& m) { m.json["bufferViews"][0]["byteLength"] = 40; }, "Draco mesh");
    refused([](Model& m) { m.json["bufferViews"][0]["byteLength"] = 0; }, "Draco mesh");
    refused([&](Model& m) { extension(m)["attributes"]["NORMAL"] = 6; },
            "an attribute 6 in the Draco data, got none");
    refused([&](Model& m) { extension(m)["attributes"]["NORMAL"] = 3; },
            "3 components of the Draco attribute 3, got 2");
    refused([&](Model& m) { extension(m)["bufferView"] = 5; }, "indices of \"bufferViews\"");
    refused([&](Model& m) { extension(m).erase("bufferView"); }, "\"bufferView\"");
    DracoSource points = grid(3);
    points.is_point_cloud = true;
    expect_refusal([&] { return gltf(compressed(points).embedded()); }, "Draco mesh");
    // Every byte wrong once: refused with one line, or a mesh.
    for (DracoSource source : {grid(5), grid(4)}) {
        source.is_sequential = source.positions.size() == 16;
        source.quantization_bits = 8;
        const Model model = compressed(source);
        const auto view = model.json["bufferViews"][0];
        for (std::size_t i = 0; i < view["byteLength"].get<std::size_t>(); ++i)
            for (const char flip : {'\x01', '\x80', '\xff'}) {
                Model damaged = model;
                damaged.buffer[i] = static_cast<char>(damaged.buffer[i] ^ flip);
                try {
                    EXPECT_EQ(defect(gltf(damaged.embedded())), "");
                } catch (const std::runtime_error& error) {
                    EXPECT_THAT(error.what(), HasSubstr("expected"));
                }
            }
    }
}

template<class Value>
std::string as_bytes(const std::vector<Value>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value)};
}

/// The grid with packed buffer views. Their layout is that of a second buffer, which does not
/// exist.
Model packed(const DracoSource& source) {
    Model model;
    std::size_t fallback = 0;
    const auto view = [&](const std::string& data, std::size_t count, std::size_t stride,
                          const char* mode, const char* filter) {
        const std::size_t index = model.add_view(data);
        Json& description = model.json["bufferViews"][index];
        Json extension = {{"buffer", 0},
                          {"byteOffset", description["byteOffset"]},
                          {"byteLength", data.size()},
                          {"byteStride", stride},
                          {"count", count},
                          {"mode", mode}};
        if (filter != nullptr)
            extension["filter"] = filter;
        description = {{"buffer", 1},
                       {"byteOffset", fallback},
                       {"byteLength", count * stride},
                       {"extensions", {{"EXT_meshopt_compression", extension}}}};
        fallback += count * stride;
        return index;
    };
    const auto accessor = [&](std::size_t buffer_view, const char* type, int component_type,
                              std::size_t count, bool normalized = false) {
        model.json["accessors"].push_back({{"bufferView", buffer_view},
                                           {"type", type},
                                           {"componentType", component_type},
                                           {"normalized", normalized},
                                           {"count", count}});
        return model.json["accessors"].size() - 1;
    };
    const std::size_t n = source.positions.size();
    // Octahedral normals of four bytes: x and y as they are where z is positive, the third is 1.
    std::vector<std::array<std::int8_t, 4>> octahedral;
    for (const glm::vec3& normal : source.normals) {
        const glm::vec3 on_planes =
            normal / (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
        const auto byte = [](float value) {
            return static_cast<std::int8_t>(std::lround(127.0f * value));
        };
        octahedral.push_back({byte(on_planes.x), byte(on_planes.y), 127, 0});
    }
    // Uvs by exponent and mantissa: u = 2^-10 * (1024 u).
    std::vector<std::array<std::uint32_t, 2>> exponential;
    for (const glm::vec2& uv : source.uvs) {
        const auto word = [](float value) {
            return 0xf6000000u | static_cast<std::uint32_t>(std::lround(1024.0f * value));
        };
        exponential.push_back({word(uv.x), word(uv.y)});
    }
    std::vector<std::uint32_t> indices;
    for (const auto& triangle : source.triangles)
        indices.insert(indices.end(), triangle.begin(), triangle.end());
    const auto positions =
        view(meshopt_attributes(as_bytes(source.positions), 12), n, 12, "ATTRIBUTES", nullptr);
    const auto normals =
        view(meshopt_attributes(as_bytes(octahedral), 4), n, 4, "ATTRIBUTES", "OCTAHEDRAL");
    const auto uvs =
        view(meshopt_attributes(as_bytes(exponential), 8), n, 8, "ATTRIBUTES", "EXPONENTIAL");
    const auto triangles = view(meshopt_triangles(indices), indices.size(), 2, "TRIANGLES", "NONE");
    const Json attributes = {{"POSITION", accessor(positions, "VEC3", 5126, n)},
                             {"NORMAL", accessor(normals, "VEC3", 5120, n, true)},
                             {"TEXCOORD_0", accessor(uvs, "VEC2", 5126, n)}};
    model.json["bufferViews"][normals]["byteStride"] = 4;
    model.json["meshes"] = {
        {{"primitives",
          {{{"attributes", attributes},
            {"indices", accessor(triangles, "SCALAR", 5123, indices.size())}}}}}};
    model.json["nodes"] = {{{"mesh", 0}}};
    model.json["extensionsUsed"] =
        model.json["extensionsRequired"] = {"EXT_meshopt_compression", "KHR_mesh_quantization"};
    return model;
}

/// Normals of the grid, of positive z.
DracoSource packable() {
    DracoSource source = grid(17);
    for (glm::vec3& normal : source.normals)
        normal = glm::normalize(glm::vec3(normal.x, normal.y, 1.0f));
    return source;
}

TEST(GltfCompression, MeshoptIsExactAndFiltersAreUndone) {
    const DracoSource source = packable();
    Model model = packed(source);
    const TriangleMesh mesh = gltf(model.embedded());
    EXPECT_EQ(defect(mesh), "");
    EXPECT_EQ(mesh.positions, source.positions);
    EXPECT_EQ(mesh.uvs, source.uvs) << "sixteenths are exact";
    EXPECT_THAT(mesh.warnings, ElementsAre());
    // The codec may turn a triangle's corners round.
    ASSERT_EQ(mesh.triangles.size(), source.triangles.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& [a, b, c] = source.triangles[i];
        EXPECT_THAT(mesh.triangles[i],
                    testing::AnyOf(Triangle{a, b, c}, Triangle{b, c, a}, Triangle{c, a, b}));
    }
    for (std::size_t i = 0; i < mesh.normals.size(); ++i)
        EXPECT_LT(glm::distance(mesh.normals[i], source.normals[i]), 0.02f);

    // Indices that are no triangles: a strip.
    const std::vector<std::uint32_t> strip = {0, 17, 1, 18, 2};
    Json& accessor = model.json["accessors"].back();
    Json& view = model.json["bufferViews"].back();
    const std::string data = meshopt_indices(strip);
    view["byteLength"] = 2 * strip.size();
    view["extensions"]["EXT_meshopt_compression"].update({{"byteOffset", model.buffer.size()},
                                                          {"byteLength", data.size()},
                                                          {"count", strip.size()},
                                                          {"mode", "INDICES"}});
    model.buffer += data;
    accessor["count"] = strip.size();
    model.json["meshes"][0]["primitives"][0]["mode"] = 5;
    EXPECT_EQ(gltf(model.embedded()).triangles,
              (std::vector<Triangle>{{0, 17, 1}, {17, 18, 1}, {1, 18, 2}}));
}

/// The ratified name of the extension, and its filter of colours.
TEST(GltfCompression, KhrMeshoptAndItsColors) {
    const DracoSource source = packable();
    Model model = packed(source);
    const std::size_t n = source.positions.size();
    // Y, Co, Cg of seven bits and alpha of six: 127 and 63 stand for 255; the bit 64 says seven.
    std::vector<std::array<std::uint8_t, 4>> colors(n, {127, 0, 0, 127}); // white
    colors[0] = {32, 63, 224, 127};                                       // red: r = y + co - cg
    colors[1] = {64, 0, 63, 127};                                         // green: y + cg
    const std::string data = meshopt_attributes(as_bytes(colors), 4);
    const std::size_t view = model.add_view(data);
    Json extension = {{"buffer", 0},
                      {"byteOffset", model.json["bufferViews"][view]["byteOffset"]},
                      {"byteLength", data.size()},
                      {"byteStride", 4},
                      {"count", n},
                      {"mode", "ATTRIBUTES"},
                      {"filter", "COLOR"}};
    model.json["bufferViews"][view] = {{"buffer", 1},
                                       {"byteLength", 4 * n},
                                       {"extensions", {{"EXT_meshopt_compression", extension}}}};
    model.json["accessors"].push_back({{"bufferView", view},
                                       {"type", "VEC4"},
                                       {"componentType", 5121},
                                       {"normalized", true},
                                       {"count", n}});
    model.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
        model.json["accessors"].size() - 1;
    Model other = model;
    other.json = Json::parse(
        replace_all(model.json.dump(), "EXT_meshopt_compression", "KHR_meshopt_compression"));
    const TriangleMesh mesh = gltf(other.embedded());
    EXPECT_EQ(mesh.positions, source.positions);
    EXPECT_THAT(mesh.warnings, ElementsAre());
    EXPECT_LT(glm::distance(mesh.colors[0], glm::vec3(1, 0, 0)), 0.01f);
    EXPECT_LT(glm::distance(mesh.colors[1], glm::vec3(0, 1, 0)), 0.02f);
    EXPECT_EQ(mesh.colors[2], glm::vec3(1));
}

TEST(GltfCompression, BrokenMeshoptDataAreOneLine) {
    const Model good = packed(packable());
    const auto refused = [&](std::size_t view, const char* key, const Json& value,
                             const std::string& part) {
        Model model = good;
        model.json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"][key] = value;
        expect_refusal([&] { return gltf(model.embedded()); }, part);
    };
    refused(0, "mode", "POINTS", "ATTRIBUTES, TRIANGLES or INDICES as \"mode\", got 'POINTS'");
    refused(0, "mode", "TRIANGLES", "as the extension allows");
    refused(0, "filter", "OCTAHEDRAL", "a filter for ATTRIBUTES of 12 bytes");
    refused(0, "filter", "ROUND", "got 'ROUND'");
    refused(3, "filter", "EXPONENTIAL", "a filter for TRIANGLES");
    refused(0, "byteStride", 3, "289 elements of 3 bytes");
    refused(0, "byteStride", 0, "289 elements of 0 bytes");
    refused(0, "byteStride", 260, "289 elements of 260 bytes");
    refused(3, "byteStride", 3, "as the extension allows");
    refused(3, "count", 5, "as the extension allows");
    refused(0, "count", 20000, "the data of 20000 elements of 12 bytes");
    refused(0, "count", 1e9, "at most 64 bytes for each");
    refused(0, "byteLength", 60, "buffer view 0: expected compressed ATTRIBUTES, got broken data");
    refused(3, "byteLength", 20, "buffer view 3: expected");
    refused(0, "byteLength", 1e9, "buffer view 0 inside");
    refused(0, "count", 288, "buffer view 0: expected compressed ATTRIBUTES, got broken data");
    // The same data as many views: a limit for all of them.
    Model many = good;
    const std::string zeros = meshopt_attributes(std::string(12 * 65536, '\0'), 12);
    many.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"].update(
        {{"byteOffset", many.buffer.size()}, {"byteLength", zeros.size()}, {"count", 65536}});
    many.buffer += zeros;
    Json& primitives = many.json["meshes"][0]["primitives"];
    for (int i = 0; i < 200; ++i) {
        many.json["bufferViews"].push_back(many.json["bufferViews"][0]);
        many.json["accessors"].push_back({{"bufferView", many.json["bufferViews"].size() - 1},
                                          {"type", "VEC3"},
                                          {"componentType", 5126},
                                          {"count", 3}});
        primitives.push_back({{"attributes", {{"POSITION", many.json["accessors"].size() - 1}}}});
    }
    expect_refusal([&] { return gltf(many.embedded()); }, "at most 64 bytes for each");
    // Every byte wrong once: refused with one line, or a mesh.
    for (std::size_t i = 0; i < good.buffer.size(); i += 3) {
        Model damaged = good;
        damaged.buffer[i] = static_cast<char>(damaged.buffer[i] ^ '\x55');
        try {
            EXPECT_EQ(defect(gltf(damaged.embedded())), "");
        } catch (const std::runtime_error& error) {
            EXPECT_THAT(error.what(), HasSubstr("expected"));
        }
    }
}

} // namespace
} // namespace relumine::mesh
