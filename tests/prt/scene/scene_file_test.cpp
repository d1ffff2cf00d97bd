#include "prt/scene/scene_file.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

#include <glm/common.hpp>
#include <gtest/gtest.h>
#include <xxhash.h>

#include "files/output_file.h"
#include "prt/glossy/glossy_precompute.h"
#include "prt/precompute.h"
#include "prt/scene/packed_sections.h"
#include "prt/scene/section_file.h"
#include "prt/scene/section_format.h"
#include "prt/visibility/ray_scene.h"
#include "tests/own_folder.h"
#include "tests/prt/damaged_file.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

namespace fs = std::filesystem;

Scene scene_of(const mesh::TriangleMesh& mesh, const PrecomputeOptions& options) {
    return {.mesh = mesh,
            .transfer = precompute(vertex_receivers(mesh), RayScene(mesh), options),
            .settings = {.tolerance = options.tolerance,
                         .epsilon = options.epsilon,
                         .min_level = options.min_level,
                         .face_resolution = options.face_resolution,
                         .bias = options.bias,
                         .floor_vertices = 2,
                         .source = "bunny \"quoted\" \xc3\xa9.ply",
                         .source_hash = 0xfedcba9876543210}};
}

/// Everything that a file can hold.
Scene rich_scene() {
    mesh::TriangleMesh mesh = scenes::sphere_and_box_on_floor();
    mesh.positions.emplace_back(9.0f); // unreferenced
    mesh.normals.emplace_back(0.0f);
    std::mt19937 random(1);
    for (std::size_t i = 0; i < mesh.num_vertices(); ++i) {
        mesh.colors.push_back(glm::abs(scenes::random_direction(random)));
        mesh.uvs.emplace_back(i, 0.5f);
    }
    return scene_of(mesh, {.tolerance = 0.03f, .face_resolution = 32, .bias = 1e-3f});
}

/// About a kilobyte.
Scene tiny_scene() {
    return scene_of(scenes::box(glm::vec3(-1.0f), glm::vec3(1.0f)),
                    {.tolerance = 0.1f, .min_level = 1, .face_resolution = 4, .bias = 1e-3f});
}

bool same(const Scene& a, const Scene& b) {
    const SceneSettings &s = a.settings, &t = b.settings;
    return a.mesh.positions == b.mesh.positions && a.mesh.triangles == b.mesh.triangles &&
           a.mesh.normals == b.mesh.normals && a.mesh.colors == b.mesh.colors &&
           a.mesh.uvs == b.mesh.uvs &&
           a.transfer.quadtree.split_flags() == b.transfer.quadtree.split_flags() &&
           a.transfer.order == b.transfer.order && a.transfer.normals == b.transfer.normals &&
           a.transfer.counts.num_receivers == b.transfer.counts.num_receivers &&
           a.transfer.counts.num_leaves == b.transfer.counts.num_leaves &&
           a.transfer.counts.visible == b.transfer.counts.visible &&
           a.transfer.counts.mixed == b.transfer.counts.mixed &&
           a.transfer.counts.mixed_before == b.transfer.counts.mixed_before &&
           a.transfer.counts.counts == b.transfer.counts.counts && s.tolerance == t.tolerance &&
           s.epsilon == t.epsilon && s.min_level == t.min_level &&
           s.face_resolution == t.face_resolution && s.bias == t.bias &&
           s.floor_vertices == t.floor_vertices && s.source == t.source &&
           s.source_hash == t.source_hash;
}

class SceneFileTest : public tests::FolderTest {
protected:
    void expect_refused(const std::string& reason) const {
        scenes::expect_refused(file_, reason, [&] { static_cast<void>(load_scene(file_)); });
    }

    fs::path file_ = folder_ / "scene.prt";
};

TEST_F(SceneFileTest, RoundTripKeepsEveryBit) {
    Scene scene = rich_scene();
    const std::uint64_t size = save_scene(file_, scene);
    EXPECT_EQ(size, fs::file_size(file_));
    EXPECT_TRUE(same(load_scene(file_), scene));
    scene.settings.epsilon = 5e-5f;
    scene.settings.tolerance = 0.1f; // no binary fraction
    scene.mesh.colors.clear();
    scene.mesh.uvs.clear();
    save_scene(file_, scene);
    const Scene loaded = load_scene(file_);
    EXPECT_TRUE(same(loaded, scene));
    EXPECT_EQ(std::memcmp(loaded.mesh.normals.data(), scene.mesh.normals.data(),
                          scene.mesh.num_vertices() * sizeof(glm::vec3)),
              0);
}

TEST_F(SceneFileTest, AFileNameThatIsNotUnicodeIsKeptReadable) {
    Scene scene = tiny_scene();
    scene.settings.source = "latin-1 \xe9.ply";
    save_scene(file_, scene);
    EXPECT_EQ(load_scene(file_).settings.source.find("latin-1 "), 0u);
}

TEST_F(SceneFileTest, EveryTruncationIsRefused) {
    save_scene(file_, tiny_scene());
    const std::vector<std::byte> bytes = files::read(file_);
    ASSERT_LT(bytes.size(), 2000u);
    for (std::size_t length = bytes.size(); length-- > 0;) {
        fs::resize_file(file_, length);
        expect_refused("");
    }
}

TEST_F(SceneFileTest, EveryCorruptByteIsRefusedOrHarmless) {
    const Scene scene = tiny_scene();
    save_scene(file_, scene);
    const std::vector<std::byte> bytes = files::read(file_);
    std::mt19937 random(2);
    for (std::size_t i = 0; i < bytes.size(); ++i)
        for (const unsigned change : {1u, 2u, 4u, 8u, 16u, 32u, 64u, 128u, 255u,
                                      1u + static_cast<unsigned>(random() % 255u)}) {
            scenes::put_byte(file_, i, bytes[i] ^ static_cast<std::byte>(change));
            try {
                EXPECT_TRUE(same(load_scene(file_), scene)) << "byte " << i;
            } catch (const std::runtime_error& error) {
                const std::string message = error.what();
                EXPECT_EQ(message.find(file_.string() + ": "), 0u) << message;
                EXPECT_EQ(message.find('\n'), std::string::npos) << message;
            }
            scenes::put_byte(file_, i, bytes[i]);
        }
}

/// Elements of a section, changed and put back; the file's checksums are right, its content is not.
template<typename Element>
void change(Sections& sections, const std::string& name,
            const std::function<void(std::vector<Element>&)>& how) {
    std::vector<std::byte>& bytes = sections.at(name);
    std::vector<Element> elements(bytes.size() / sizeof(Element));
    if (!elements.empty())
        std::memcpy(elements.data(), bytes.data(), bytes.size());
    how(elements);
    bytes.resize(elements.size() * sizeof(Element));
    if (!elements.empty())
        std::memcpy(bytes.data(), elements.data(), bytes.size());
}

class ForgedSceneTest : public SceneFileTest {
protected:
    void SetUp() override {
        SceneFileTest::SetUp();
        save_scene(file_, rich_scene());
        good_ = read_sections(file_);
    }
    void refused(const std::string& reason, const std::function<void(Sections&)>& forge) const {
        Sections sections = good_;
        forge(sections);
        write_sections(file_, to_write(sections));
        expect_refused(reason);
    }
    template<typename Element>
    void refused(const std::string& reason, const std::string& name,
                 const std::function<void(std::vector<Element>&)>& how) const {
        refused(reason, [&](Sections& sections) { change<Element>(sections, name, how); });
    }
    Sections good_;
};

TEST_F(ForgedSceneTest, MissingSections) {
    for (const auto& [name, bytes] : good_) {
        if (name == "colors" || name == "uvs")
            continue; // these two may be absent
        refused("expected a section '" + name + "', got none",
                [&, n = name](Sections& s) { s.erase(n); });
    }
    Sections sections = good_;
    sections.erase("colors");
    sections.erase("uvs");
    sections["of_the_future"] = std::vector<std::byte>(10);
    write_sections(file_, to_write(sections));
    EXPECT_TRUE(load_scene(file_).mesh.colors.empty());
}

TEST_F(ForgedSceneTest, SizesThatAreNoWholeNumberOfElements) {
    for (const char* name :
         {"positions", "triangles", "normals", "colors", "uvs", "order", "visible", "mixed"})
        refused(std::string("'") + name + "'", [&](Sections& s) { s.at(name).pop_back(); });
}

TEST_F(ForgedSceneTest, SizesThatContradictEachOther) {
    refused<glm::vec3>("'normals'", "positions", [](auto& p) { p.emplace_back(0.0f); });
    refused<glm::vec3>("", "positions", [](auto& p) { p.pop_back(); });
    refused<glm::vec3>("", "positions", [](auto& p) { p.clear(); });
    refused<glm::vec3>("'normals'", "normals", [](auto& n) { n.pop_back(); });
    refused<glm::vec3>("'colors'", "colors", [](auto& c) { c.pop_back(); });
    refused<glm::vec3>("'colors'", "colors", [](auto& c) { c.clear(); });
    refused<glm::vec2>("'uvs'", "uvs", [](auto& uv) { uv.emplace_back(0.0f); });
    refused<std::uint32_t>("'order'", "order", [](auto& o) { o.pop_back(); });
    refused<std::uint32_t>("'order'", "order", [](auto& o) { o.push_back(0); });
    refused<std::uint64_t>("'count_codes'", "visible", [](auto& v) { v.pop_back(); });
    refused<std::uint64_t>("'count_codes'", "visible", [](auto& v) { v.clear(); });
    refused<std::uint64_t>("'count_codes'", "mixed", [](auto& m) { m.push_back(0); });
    refused<std::uint8_t>("'count_codes'", "count_codes", [](auto& c) { c.pop_back(); });
    refused<std::uint8_t>("'count_codes'", "count_codes", [](auto& c) { c.resize(c.size() + 8); });
    refused<std::uint8_t>("'count", "count_codes", [](auto& c) { c.clear(); });
}

TEST_F(ForgedSceneTest, IndicesAndNumbersOutOfRange) {
    const auto num_vertices =
        static_cast<std::uint32_t>(good_.at("positions").size() / sizeof(glm::vec3));
    for (const std::uint32_t index : {num_vertices, ~0u})
        refused<std::uint32_t>("'triangles'", "triangles",
                               [&](auto& t) { t[t.size() / 2] = index; });
    for (const float value :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        refused<glm::vec3>("coordinates", "positions", [&](auto& p) { p[7].y = value; });
        refused<glm::vec3>("normals", "normals", [&](auto& n) { n[7].z = -value; });
        refused<glm::vec3>("colours", "colors", [&](auto& c) { c[7].z = value; });
    }
    refused<std::uint32_t>("'order'", "order", [&](auto& o) { o[3] = num_vertices; });
    refused<std::uint32_t>("'order'", "order", [](auto& o) { o[3] = o[4]; });
}

TEST_F(ForgedSceneTest, BitsThatContradictTheCounts) {
    refused<std::uint64_t>("'count_codes'", "mixed", [](auto& m) {
        const auto word = std::find_if(m.begin(), m.end(), [](std::uint64_t w) { return w != 0; });
        *word &= *word - 1;
    });
    refused("'count_codes'", [](Sections& s) { s.at("visible") = s.at("mixed"); });
    refused<std::uint64_t>("'count_codes'", "visible",
                           [](auto& v) { v.back() = ~std::uint64_t{0}; });
}

TEST_F(ForgedSceneTest, BrokenTrees) {
    const auto flags = [&](const std::function<void(std::vector<std::uint8_t>&)>& how) {
        refused<std::uint8_t>("", "quadtree", how);
    };
    flags([](auto& b) { b.clear(); });
    flags([](auto& b) { b.resize(3); });
    flags([](auto& b) { b.pop_back(); });
    flags([](auto& b) { b.push_back(0); });
    flags([](auto& b) { b[4] ^= 1u; });               // the first face is a leaf
    flags([](auto& b) { b[b.size() / 2] ^= 0x10u; }); // a leaf more or less
    flags([](auto& b) { std::fill(b.begin() + 4, b.end(), std::uint8_t{0xff}); });
    flags([](auto& b) { std::fill(b.begin() + 4, b.end(), std::uint8_t{0}); });
    flags([](auto& b) { b[0] ^= 1u; });        // number of flags
    flags([](auto& b) { b.back() |= 0x80u; }); // behind the last flag
    flags([](auto& b) { std::fill(b.begin(), b.begin() + 4, std::uint8_t{0xff}); });
    // A good tree that is not this scene's.
    flags([](auto& b) { b = {6, 0, 0, 0, 0}; });
}

TEST_F(ForgedSceneTest, SettingsThatAreNone) {
    const auto settings = [&](const std::string& text) {
        refused("'settings'", [&](Sections& s) {
            s.at("settings").resize(text.size());
            if (!text.empty())
                std::memcpy(s.at("settings").data(), text.data(), text.size());
        });
    };
    settings("");
    settings("{}");
    const std::vector<std::byte>& bytes = good_.at("settings");
    settings(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()) + '\0');
    settings("[1, 2]");
    settings("null");
    settings("{\"tolerance\": 1");
    settings(std::string(100000, '['));
    const auto with = [](const std::string& name, const std::string& value) {
        std::vector<std::pair<std::string, std::string>> members = {
            {"tolerance", "0.1"},    {"min_level", "3"}, {"face_resolution", "64"},  {"bias", "0"},
            {"floor_vertices", "0"}, {"source", "\"\""}, {"source_hash", "\"00ff\""}};
        std::string text;
        for (auto& [key, content] : members)
            text +=
                (text.empty() ? "{\"" : ", \"") + key + "\": " + (key == name ? value : content);
        return text + "}";
    };
    settings(with("tolerance", "\"much\""));
    settings(with("tolerance", "null"));
    settings(with("min_level", "[]"));
    settings(with("source", "7"));
    settings(with("source_hash", "\"none\""));
    settings(with("source_hash", "12"));
    settings(with("source_hash", "\"123456789abcdef01\""));
    // Numbers that the member cannot hold.
    settings(with("min_level", "-1"));
    settings(with("min_level", "1.5"));
    settings(with("face_resolution", "4294967296"));
    settings(with("face_resolution", "1e30"));
    settings(with("floor_vertices", "-7"));
    settings(with("tolerance", "1e300"));
}

TEST_F(SceneFileTest, RefusesToSaveWhatItCouldNotLoad) {
    Scene scene = tiny_scene();
    scene.mesh.positions.pop_back(); // receivers that are not the mesh's vertices
    scene.mesh.normals.pop_back();
    EXPECT_THROW(save_scene(file_, scene), std::invalid_argument);
    EXPECT_TRUE(fs::is_empty(folder_));
}

/// A scene with surfaces, highlights and an eye.
Scene glossy_scene() {
    Scene scene = tiny_scene();
    scene.receivers = vertex_receivers(scene.mesh);
    look_from(scene.receivers, {0.0f, 1.0f, 4.0f});
    Surface shiny{.albedo = glm::vec3(0.5f),
                  .specular = glm::vec3(0.04f),
                  .highlight = Highlight::Ggx,
                  .roughness_or_exponent = 0.4f};
    scene.receivers.surfaces.assign(scene.receivers.size(), shiny);
    set_surfaces(scene.transfer, scene.receivers);
    scene.transfer.glossy = precompute_glossy(scene.receivers, RayScene(scene.mesh), scene.transfer,
                                              {.tolerance = 0.3f, .face_resolution = 4});
    set_surfaces(scene.transfer, scene.receivers);
    scene.settings.glossy_tolerance = 0.3f;
    scene.settings.view = Camera{.eye = {0.0f, 1.0f, 4.0f}};
    scene.settings.camera =
        Camera{.eye = {1.0f, 2.0f, 3.0f}, .fov_degrees = 50.0f, .roll_degrees = 12.5f};
    scene.mesh.offset = {691234.1, -520.0, 5334567.7};
    return scene;
}

TEST_F(SceneFileTest, RefusesValuesThatCannotBeLitOrDrawn) {
    constexpr float NaN = std::numeric_limits<float>::quiet_NaN();
    constexpr float Infinity = std::numeric_limits<float>::infinity();
    const Scene good = glossy_scene();
    EXPECT_NO_THROW(save_scene(file_, good));
    const Scene loaded = load_scene(file_);
    EXPECT_EQ(loaded.settings.view, good.settings.view);
    EXPECT_EQ(loaded.settings.camera, good.settings.camera);
    EXPECT_EQ(loaded.mesh.offset, good.mesh.offset);
    const auto refused = [&](const std::string& reason, const std::function<void(Scene&)>& how) {
        Scene scene = good;
        how(scene);
        fs::remove(file_);
        scenes::expect_refused(file_, reason, [&] { save_scene(file_, scene); });
        EXPECT_TRUE(fs::is_empty(folder_));
    };
    for (const float value : {NaN, Infinity, -1.0f, 3e38f, 1.5f}) {
        refused("surfaces of albedo 0 to 1, got element 7",
                [&](Scene& s) { s.receivers.surfaces[7].albedo.g = value; });
        refused("surfaces of specular colour 0 to 1, got element 3",
                [&](Scene& s) { s.receivers.surfaces[3].specular.b = value; });
        refused("roughness of 0 to 1",
                [&](Scene& s) { s.receivers.surfaces[0].roughness_or_exponent = value; });
        refused("directions to the eye of length 1",
                [&](Scene& s) { s.receivers.to_eye[2] *= value * 1.01f; });
        refused("normals of length 1 or 0", [&](Scene& s) { s.mesh.normals[5] *= value * 1.01f; });
    }
    refused("exponent of 0 to 1000000", [](Scene& s) {
        s.receivers.surfaces[1].highlight = Highlight::BlinnPhong;
        s.receivers.surfaces[1].roughness_or_exponent = 1e30f;
    });
    refused("directions to the eye of length 1",
            [](Scene& s) { s.receivers.to_eye[2] = glm::vec3(0.0f); });
    for (const float value : {NaN, Infinity, -1.0f, 3e38f})
        refused("highlights of a transfer within",
                [&](Scene& s) { s.transfer.glossy->lobes[0].scales.back() = value; });
    // Embree aborts for rays from beyond 1.8e18.
    for (const float value : {NaN, Infinity, 1e19f, -1.9e18f}) {
        refused("coordinates", [&](Scene& s) { s.mesh.positions[7].z = value; });
        refused("an offset within", [&](Scene& s) { s.mesh.offset.y = 1e30 * double{value}; });
        refused("coordinates within", [&](Scene& s) { s.settings.view->eye.x = value; });
        refused("coordinates within", [&](Scene& s) { s.settings.camera->eye.x = value; });
    }
    refused("coordinates within", [](Scene& s) { s.settings.bias = 1e19f; });
    refused("a bias >= 0", [](Scene& s) { s.settings.bias = -1.0f; });
    refused("a tolerance >= 0", [](Scene& s) { s.settings.tolerance = -1.0f; });
    refused("a face resolution from 1", [](Scene& s) { s.settings.face_resolution = 0; });
    refused("a floor among", [](Scene& s) { s.settings.floor_vertices = 1000; });
    refused("clusters of levels", [](Scene& s) { s.settings.face_resolution = 1; });
    refused("clusters of levels", [](Scene& s) { s.settings.min_level = 5; });
    refused("tolerance of the highlights, got none",
            [](Scene& s) { s.settings.glossy_tolerance.reset(); });
    refused("highlights, got none", [](Scene& s) { s.transfer.glossy.reset(); });
    refused("expected triangles, got none", [](Scene& s) { s.mesh.triangles.clear(); });
    refused("colours of 0 to", [](Scene& s) {
        s.mesh.colors.assign(s.mesh.num_vertices(), glm::vec3(1.0f));
        s.mesh.colors[3].g = -1.0f;
    });
    refused("finite uvs", [](Scene& s) {
        s.mesh.uvs.assign(s.mesh.num_vertices(), glm::vec2(0.0f));
        s.mesh.uvs[2].x = Infinity;
    });
}

TEST_F(SceneFileTest, OtherVersionsAreRefused) {
    save_scene(file_,
               scene_of(scenes::floor_grid(3, 1.0f), {.tolerance = 0.2f, .face_resolution = 4}));
    for (const std::uint32_t version : {0u, 1u, SceneFileVersion - 1}) {
        scenes::sign_as_version(file_, version);
        expect_refused(fmt::format("expected .prt version {}, got version {}, made by an older "
                                   "relumine: run precompute again",
                                   SceneFileVersion, version));
    }
    scenes::sign_as_version(file_, SceneFileVersion + 1);
    expect_refused("made by a newer relumine");
}

TEST_F(SceneFileTest, UnwritablePlacesLeaveNothing) {
    const fs::path missing = folder_ / "missing" / "scene.prt";
    scenes::expect_refused(missing, "cannot write", [&] { save_scene(missing, tiny_scene()); });
    EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(SceneFileTest, NothingToLoad) {
    expect_refused("cannot read");
    scenes::expect_refused(folder_, "cannot read", [&] { static_cast<void>(load_scene(folder_)); });
}

} // namespace
} // namespace relumine::prt
