// `relumine info`: what it tells.
#include "prt/scene/scene_file.h"
#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

class Info : public AppTest {
protected:
    Info() { write("mesh.obj", octahedron_obj()); }
};

TEST_F(Info, Mesh) {
    const nlohmann::json info = succeed("info mesh.obj --json").json();
    EXPECT_EQ(info["kind"], "mesh");
    EXPECT_EQ(info["vertices"], 6);
    EXPECT_EQ(info["triangles"], 8);
    EXPECT_EQ(info["min"], (nlohmann::json{-1.0, -1.0, -1.0}));
    EXPECT_EQ(info["max"], (nlohmann::json{1.0, 1.0, 1.0}));
    EXPECT_EQ(info["diagnosis"]["isolated_vertices"], 0);
    EXPECT_EQ(info["colors"], false);
    EXPECT_NE(succeed("info mesh.obj").out.find("6 vertices, 8 triangles"), std::string::npos);
    write("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_NE(succeed("info one.obj").out.find("3 vertices, 1 triangle\n"), std::string::npos);
}

TEST_F(Info, NamesInFilesDoNotCommandTheTerminal) {
    const std::string name = "\x1b]0;title\a\xff.obj";
    write(name, octahedron_obj());
    succeed({"precompute", name, "-o", "scene.prt", "--tolerance", "1", "-q", "--refine", "off",
             "--bounces", "0"});
    const std::string out = succeed("info scene.prt").out;
    EXPECT_NE(out.find("from ?]0;title?"), std::string::npos) << out;
    EXPECT_EQ(out.find_first_of("\x1b\a\xff"), std::string::npos) << out;
}

TEST_F(Info, WithoutRoomForAThreadItEndsWithOneLine) {
    // Threads get stacks of this size, which no address space has.
    const Result result =
        fail("info mesh.obj", {"cannot start a thread"}, {.stack_bytes = 1ull << 58});
    EXPECT_EQ(result.signal, 0);
}

/// A triangle that an animation lifts by 2 within a second.
TEST_F(Info, PoseOfAMesh) {
    write("lift.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "buffers": [{"byteLength": 68, "uri": "data:application/octet-stream;base64,)"
                       "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAAAAAAAAAAAA"
                       "AAAAAAAAAAAAQAAAAAA="
                       R"("}], "bufferViews": [{"buffer": 0, "byteLength": 36},
        {"buffer": 0, "byteOffset": 36, "byteLength": 8},
        {"buffer": 0, "byteOffset": 44, "byteLength": 24}], "accessors": [
        {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
         "max": [1, 1, 0]},
        {"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0],
         "max": [1]},
        {"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"}],
        "animations": [{"name": "up", "samplers": [{"input": 1, "output": 2}],
                        "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]
                       }]})");
    const auto low = [&](const std::vector<std::string>& pose) {
        std::vector<std::string> arguments = {"info", "lift.gltf", "--json"};
        arguments.insert(arguments.end(), pose.begin(), pose.end());
        return succeed(arguments).json()["min"][1];
    };
    EXPECT_EQ(low({}), 0.0);
    EXPECT_EQ(low({"--pose", "up@0.5"}), 1.0);
    EXPECT_EQ(low({"--pose", "0@3"}), 2.0);
    write("white.hdr", white_hdr());
    succeed("relight lift.gltf white.hdr --pose up@1 -o posed.png --size 32x32");
    fail("info lift.gltf --pose down@1", {"lift.gltf", "down"});
    fail("info mesh.obj --pose 0@1", {"expected .glb or .gltf for a pose"});
    misuse("info white.hdr --pose 0@1", "--pose");
    succeed("precompute mesh.obj -o scene.prt --tolerance 1 -q --refine off --bounces 0");
    misuse("info scene.prt --pose 0@1", "--pose");
    misuse("relight scene.prt white.hdr --pose 0@1 -o posed.png", "--pose");
}

/// A triangle that is black, or white as the variant "snow".
TEST_F(Info, VariantsOfAMesh) {
    write("coat.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0},
            "material": 0, "extensions": {"KHR_materials_variants": {"mappings": [
            {"material": 1, "variants": [1]}]}}}]}],
        "extensionsUsed": ["KHR_materials_variants"],
        "extensions": {"KHR_materials_variants": {"variants": [{"name": "coal"},
                                                               {"name": "snow"}]}},
        "materials": [{"doubleSided": true, "pbrMetallicRoughness":
                       {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0}},
                      {"doubleSided": true, "pbrMetallicRoughness": {"metallicFactor": 0}}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,)"
                       "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"
                       R"("}], "bufferViews": [{"buffer": 0, "byteLength": 36}], "accessors": [
        {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
         "max": [1, 1, 0]}]})");
    write("white.hdr", white_hdr());
    EXPECT_EQ(succeed("info coat.gltf --json").json()["variants"],
              (nlohmann::json{"coal", "snow"}));
    const auto first_vertex = [&](const std::vector<std::string>& variant) {
        std::vector<std::string> arguments = {"relight", "coat.gltf", "white.hdr", "-o",
                                              "coat.npy"};
        arguments.insert(arguments.end(), variant.begin(), variant.end());
        succeed(arguments);
        return npy_values(read("coat.npy"))[0][0];
    };
    EXPECT_LT(first_vertex({}), 0.05f);
    EXPECT_GT(first_vertex({"--variant", "snow"}), 0.3f);
    fail("relight coat.gltf white.hdr --variant ice -o coat.png", {"'coal', 'snow'", "'ice'"});
    fail("info mesh.obj --variant snow", {"expected .glb or .gltf for a variant"});
    misuse("info white.hdr --variant snow", "--variant");
}

TEST_F(Info, MaterialsOfAMesh) {
    write("a.mtl",
          "newmtl shiny\nKd 0.5\nKs 0.25\nNs 50\nmap_Kd gone.png\nnewmtl metal\nPr 0.25\nPm 1\n");
    write("parts.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\no lid\nusemtl shiny\nf 1 2 3\n");
    const nlohmann::json info = succeed("info parts.obj --json").json();
    ASSERT_EQ(info["materials"].size(), 2u);
    EXPECT_EQ(info["materials"][0]["name"], "shiny");
    EXPECT_EQ(info["materials"][0]["model"], "phong");
    EXPECT_EQ(info["materials"][0]["exponent"], 50.0);
    EXPECT_EQ(info["materials"][1]["model"], "metallic-roughness");
    EXPECT_EQ(info["materials"][1]["roughness"], 0.25);
    EXPECT_EQ(info["groups"], nlohmann::json{"lid"});
    EXPECT_EQ(info["missing"], nlohmann::json{"gone.png"});
    const Result told = succeed("info parts.obj");
    constexpr const char* Heads =
        "material  model               colour       metallic  roughness  specular        exponent";
    for (const char* part :
         {Heads,
          "shiny     Blinn-Phong         0.5 0.5 0.5                       0.25 0.25 0.25  50",
          "metal     metallic-roughness  1 1 1        1         0.25", "group               lid",
          "not found           gone.png"})
        EXPECT_NE(told.out.find(part), std::string::npos) << part << told.described();
    write("a.mtl", "newmtl shiny\nKd 2\n");
    EXPECT_NE(
        succeed({"info", "parts.obj"})
            .out.find("left out            the material shiny: expected 0 to 1 as \"Kd\", got "
                      "2: it counts as 1"),
        std::string::npos);
    write("a.gltf", "{\"asset\": {\"version\": \"2.0\"}");
    fail("info a.gltf", {"a.gltf: expected glTF's JSON, got a syntax error"});
    EXPECT_TRUE(succeed("info mesh.obj --json").json()["materials"].empty());
}

TEST_F(Info, HowAMeshIsReadIsSaidAsByTheFirstPicture) {
    // A pyramid without its floor, its normals inward; one normal for each face.
    write("tent.obj", "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 1 0\n"
                      "vn 0 0.7 -0.7\nvn 0.7 0.7 0\nvn 0 0.7 0.7\nvn -0.7 0.7 0\n"
                      "f 1//1 2//1 5//1\nf 2//2 3//2 5//2\nf 3//3 4//3 5//3\nf 4//4 1//4 5//4\n");
    const nlohmann::json info = succeed({"info", "tent.obj", "--json"}).json();
    const std::string note = "7 vertices are added behind the 5 of the file, where normals or "
                             "colours of faces differ";
    const std::string warning =
        "4 of 4 triangles are wound against their normals: they are turned around";
    EXPECT_EQ(info["notes"], nlohmann::json{note});
    EXPECT_EQ(info["left_out"], nlohmann::json{warning});
    const Result first = succeed({"precompute", "tent.obj", "-o", "tent.prt", "--face-resolution",
                                  "8", "--refine", "off", "--bounces", "0"});
    EXPECT_NE(first.out.find("tent.obj: " + note), std::string::npos) << first.described();
    EXPECT_NE(first.err.find("tent.obj: " + warning), std::string::npos) << first.described();
}

TEST_F(Info, ExtensionsInCapitals) {
    write("MESH.OBJ", octahedron_obj());
    write("ENV.HDR", white_hdr());
    EXPECT_EQ(succeed("info MESH.OBJ --json").json()["kind"], "mesh");
    EXPECT_EQ(succeed("info ENV.HDR --json").json()["kind"], "environment");
}

TEST_F(Info, CheckFindsEveryFlippedBit) {
    succeed("precompute mesh.obj -o scene.prt --face-resolution 16 -q --refine off");
    EXPECT_NE(succeed("info scene.prt --check").out.find("checked: whole and sound"),
              std::string::npos);
    EXPECT_EQ(succeed("info scene.prt --check --json").json()["checked"], true);
    misuse("info mesh.obj --check", "--check: expected a scene (.prt), got 'mesh.obj'");
    const std::string whole = read("scene.prt");
    // All over the file; tests of prt flip every bit.
    for (std::size_t i = 0; i < 60; ++i) {
        std::string bytes = whole;
        const std::size_t at = i * (whole.size() - 1) / 59;
        bytes[at] = static_cast<char>(bytes[at] ^ 1 << i % 8);
        write("scene.prt", bytes);
        fail("info scene.prt --check", {"scene.prt: expected "});
    }
    // The next version, by its number.
    std::string newer = whole;
    newer[12] = 6;
    write("scene.prt", newer);
    fail("info scene.prt --check",
         {"scene.prt: expected .prt version 5, got version 6, made by a newer relumine"});
}

TEST_F(Info, Scene) {
    succeed("precompute mesh.obj -o scene.prt --face-resolution 16 --tolerance 0.25 --floor 4 "
            "--refine off");
    const nlohmann::json info = succeed("info scene.prt --json").json();
    EXPECT_EQ(info["kind"], "scene");
    EXPECT_EQ(info["vertices"], 22);
    EXPECT_EQ(info["tolerance"], 0.25);
    EXPECT_EQ(info["min_depth"], 3);
    EXPECT_EQ(info["face_resolution"], 16);
    EXPECT_GT(info["bias"], 0.0);
    EXPECT_EQ(info["floor"], 4);
    EXPECT_EQ(info["source"], "mesh.obj");
    EXPECT_FALSE(info.contains("epsilon"));
    EXPECT_EQ(info["bounces"], true);
    EXPECT_EQ(info["groups"], nlohmann::json::array());
    prt::Scene scene = prt::load_scene(folder() / "scene.prt");
    scene.settings.epsilon = 0.5f; // the paper's form, of the library
    prt::save_scene(folder() / "scene.prt", scene);
    EXPECT_EQ(succeed("info scene.prt --json").json()["epsilon"], 0.5);
}

TEST_F(Info, BouncesAndGroupsOfAScene) {
    std::string two = octahedron_obj();
    two.insert(two.find("f "), "g near\n");
    write("two.obj", two + "v 3 0 0\nv 4 0 0\nv 3 1 0\ng far\nf 7 8 9\n");
    succeed("precompute two.obj -o scene.prt --tolerance 0.5 --refine off --movable --floor 4");
    nlohmann::json info = succeed("info scene.prt --json").json();
    EXPECT_EQ(info["bounces"], true);
    EXPECT_EQ(info["groups"], (nlohmann::json{"near", "far", "floor"}));
    EXPECT_EQ(info["have_moved"], false);
    std::string out = succeed("info scene.prt").out;
    EXPECT_NE(out.find("groups              3 that can move: near, far, floor\n"),
              std::string::npos)
        << out;
    EXPECT_NE(out.find("bounces             within "), std::string::npos) << out;
    succeed("move scene.prt far=1,0,0 -o scene.prt");
    succeed("move scene.prt near=away -o scene.prt");
    info = succeed("info scene.prt --json").json();
    EXPECT_EQ(info["have_moved"], true);
    EXPECT_EQ(info["taken_away"], (nlohmann::json{"near"}));
    out = succeed("info scene.prt").out;
    EXPECT_NE(out.find("near, far, floor; some have moved\n"), std::string::npos) << out;
    EXPECT_NE(out.find("taken away          near\n"), std::string::npos) << out;
    succeed("precompute mesh.obj -o scene.prt --tolerance 0.5 --refine off");
    EXPECT_NE(succeed("info scene.prt").out.find("\nbounces             none\n"), std::string::npos)
        << "no surface sees another";
}

TEST_F(Info, BrightestDirectionAndRangeOfAnEnvironment) {
    write("lamp.hdr", lamp_hdr(32)); // +X
    const nlohmann::json info = succeed("info lamp.hdr --json").json();
    EXPECT_EQ(info["width"], 128);
    EXPECT_EQ(info["height"], 64);
    EXPECT_EQ(info["face_resolution"], 32);
    EXPECT_GT(info["brightest_direction"][0], 0.99);
    EXPECT_EQ(info["max_luminance"], 512.0);
    EXPECT_EQ(info["samples_on_borders"], false);
    for (const char* key : {"assumptions", "mean_radiance", "mean_luminance", "dynamic_range_ev",
                            "num_nan", "num_infinite", "num_negative"})
        EXPECT_TRUE(info.contains(key)) << key;
    const Result told = succeed("info lamp.hdr");
    for (const char* part : {"lat-long", "assumed", "mean radiance", "brightest", "bad pixels"})
        EXPECT_NE(told.out.find(part), std::string::npos) << part << told.described();
}

TEST_F(Info, LayoutOnRequest) {
    write("odd.hdr",
          hdr_file(30, 30, [](std::uint32_t, std::uint32_t) { return Rgb{1.0f, 1.0f, 1.0f}; }));
    fail("info odd.hdr", {"30x30"});
    EXPECT_EQ(succeed("info odd.hdr --layout latlong --json").json()["layout"], "lat-long");
    fail("info odd.hdr --layout cube", {"odd.hdr", "30x30"});
    misuse("info odd.hdr --layout dodecahedron", "--layout");
}

} // namespace
} // namespace relumine::app
