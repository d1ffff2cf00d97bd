// `relumine export web`: what is in the folder and in the single file, and what is refused.
// Browsers look at real pages in tests/web/page_test.py.
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>

#include "app/web/web_look.h"
#include "prt/scene/relighting_file.h"
#include "prt/scene/section_reader.h"
#include "tests/app/command.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ExportWeb : public AppTest {
protected:
    ExportWeb() {
        write("mesh.obj", octahedron_obj());
        write("white.hdr", white_hdr());
        std::filesystem::create_directory(folder() / "parts");
        write("parts/index.html", "<title>{{title}}</title>\n{{assets}}\n{{script}}\n");
        write("parts/relumine-viewer.js", "const text = '</script>';");
        write("parts/relumine.wasm.gz", "wasm");
        write("parts/LICENSE-three.txt", "MIT");
        ::setenv("RELUMINE_WEB", (folder() / "parts").c_str(), 1);
    }
    ~ExportWeb() override { ::unsetenv("RELUMINE_WEB"); }

    void precompute(const std::vector<std::string>& options) {
        std::vector<std::string> arguments = {
            "precompute",        "mesh.obj", "-o",       "scene.prt", "--floor", "9",
            "--face-resolution", "128",      "--refine", "off",       "-q"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        succeed(arguments);
    }
    [[nodiscard]] nlohmann::json manifest() const {
        return nlohmann::json::parse(read("site/scene.json"));
    }
};

/// A page stands level, and lets nobody farther away than 40 radii: orthographic cameras come near.
TEST_F(ExportWeb, CamerasOfFiles) {
    const auto camera_of = [&](const std::string& camera, const std::string& rotation) {
        write("a.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
            "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 4], "rotation": )" +
                            rotation + R"(}], "cameras": [)" + camera + R"(],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "buffers": [{"byteLength": 36, "uri": "a.bin"}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                           "min": [0, 0, 0], "max": [1, 1, 0]}]})");
        constexpr std::array<float, 9> Corners = {0, 0, 0, 1, 0, 0, 0, 1, 0};
        write("a.bin", std::string(reinterpret_cast<const char*>(Corners.data()), sizeof Corners));
        succeed("precompute a.gltf -o scene.prt --face-resolution 8 --refine off -q");
        return succeed("export web scene.prt white.hdr -o site --samples 0").err;
    };
    const std::string perspective =
        R"({"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}})";
    EXPECT_THAT(camera_of(perspective, "[0, 0, 0.258819, 0.965926]"),
                HasSubstr("left out: the camera's turn by 30 degrees about its view"));
    EXPECT_THAT(camera_of(perspective, "[0, 0, 0, 1]"), Not(HasSubstr("camera")));
    EXPECT_THAT(camera_of(R"({"type": "orthographic", "orthographic":
                          {"xmag": 1, "ymag": 1, "znear": 0.1, "zfar": 10}})",
                          "[0, 0, 0, 1]"),
                Not(HasSubstr("camera")));
    const nlohmann::json found = manifest();
    const double radius = found["subject"]["radius"], distance = found["camera"]["eye"][2],
                 half_fov = 0.5 * found["camera"]["fov"].get<double>() * 3.14159265 / 180.0;
    EXPECT_LT(distance, 40.0 * radius);
    EXPECT_NEAR(distance * std::tan(half_fov), 1.0, 1e-3) << "ymag";
}

TEST_F(ExportWeb, WritesAFolderThatTheRuntimeReads) {
    precompute({"--tolerance", "0.02", "--bounces", "0.05"});
    std::filesystem::copy(folder() / "scene.prt", folder() / "A <b> & c.prt");
    const nlohmann::json report =
        succeed({"export", "web", "A <b> & c.prt", "white.hdr", "-o", "site", "--tolerance", "0.1",
                 "--samples", "20", "--json"})
            .json();
    EXPECT_EQ(read("site/index.html"),
              "<title>A &lt;b> &amp; c</title>\n"
              "<script type=\"module\" src=\"relumine-viewer.js\"></script>\n");
    std::uint64_t bytes = 0;
    for (const auto& file : std::filesystem::recursive_directory_iterator(folder() / "site"))
        bytes += file.is_regular_file() ? file.file_size() : 0;
    EXPECT_EQ(report["bytes"], bytes);
    EXPECT_LT(report["relative_l2"], 0.05);
    const prt::RelightingScene scene =
        prt::relighting_scene_of(prt::SectionReader(folder() / "site/scene.relight"));
    EXPECT_EQ(scene.scene.transfer.num_clusters(), report["clusters"]);
    EXPECT_TRUE(scene.scene.bounces);
    succeed("coarsen scene.prt --tolerance 0.1 -o coarse.prt -q");
    EXPECT_EQ(prt::load_scene(folder() / "coarse.prt").transfer.counts.counts,
              scene.scene.transfer.counts.counts);

    const nlohmann::json page = manifest();
    EXPECT_EQ(page["title"], "A <b> & c");
    EXPECT_EQ(page["bouncesError"], 0.0) << "so few receivers keep all samples";
    EXPECT_EQ(page["look"]["groups"].size(), 2u) << "the mesh and its floor";
    EXPECT_EQ(page["look"]["groups"][1]["start"], 24);
    EXPECT_TRUE(page["look"]["materials"][1]["isFloor"]);
    EXPECT_NEAR(page["environments"][0]["verified"]["relativeL2"], report["relative_l2"], 1e-9);
    EXPECT_THAT(page["tone"]["source"], HasSubstr("vec3 on_screen(int curve, vec3 radiance)"));
    // The environment is one that the program reads: white.
    succeed("relight coarse.prt site/environments/1.hdr -o light.npy -q");

    // A page may be written again.
    EXPECT_EQ(succeed("export web scene.prt white.hdr -o site --samples 0 --bounces 0 --json")
                  .json()["bounces"],
              false);
}

TEST_F(ExportWeb, PutsAllIntoASingleFile) {
    precompute({"--tolerance", "0.1"});
    succeed("export web scene.prt -o page.html --samples 0");
    const std::string page = read("page.html");
    EXPECT_THAT(page, HasSubstr("data-relumine-file=\"relumine.wasm.gz\">d2FzbQ==</script>"));
    for (const char* name :
         {"scene.json", "scene.relight", "look.bin.gz", "environments/1.hdr", "environments/2.png"})
        EXPECT_THAT(page, HasSubstr("data-relumine-file=\"" + std::string(name) + "\""));
    EXPECT_THAT(page, HasSubstr("const text = '<\\/script>';"))
        << "a script does not end within its text";
    EXPECT_FALSE(std::filesystem::exists(folder() / "scene.json"));
}

TEST_F(ExportWeb, GivesUpBouncesAndClustersForALimit) {
    precompute({"--tolerance", "0.02", "--bounces", "0.05"});
    const std::vector<std::string> command = {"export", "web",         "scene.prt", "white.hdr",
                                              "-o",     "site",        "--samples", "0",
                                              "--json", "--tolerance", "0.02",      "--max-bytes"};
    const auto with_limit = [&](std::uint64_t limit) {
        std::vector<std::string> arguments = command;
        arguments.push_back(std::to_string(limit));
        return arguments;
    };
    const nlohmann::json all = succeed(with_limit(1'000'000'000)).json();
    EXPECT_TRUE(all["bounces"]);
    const std::uint64_t bytes = all["bytes"];
    const nlohmann::json less = succeed(with_limit(bytes - 1)).json();
    EXPECT_LT(less["bytes"], bytes);
    EXPECT_FALSE(less["bounces"]);
    EXPECT_EQ(less["clusters"], all["clusters"]);
    const nlohmann::json least = succeed(with_limit(less["bytes"].get<std::uint64_t>() - 1)).json();
    EXPECT_LT(least["clusters"], all["clusters"]);
    EXPECT_GE(least["warnings"].size(), 2u);
    const std::string before = read("site/scene.json");
    fail(with_limit(1000), {"--max-bytes: expected at least "});
    EXPECT_EQ(read("site/scene.json"), before);
}

TEST_F(ExportWeb, KeepsTheColoursOfMaterials) {
    precompute({"--tolerance", "0.1", "--material", "lambert:albedo=0.8,0.4,0.2"});
    const prt::Scene scene = prt::load_scene(folder() / "scene.prt");
    const std::vector<glm::vec3> albedo = web_albedo(scene);
    for (std::size_t vertex = 0; vertex < 6; ++vertex)
        EXPECT_EQ(albedo[vertex], glm::vec3(0.8f, 0.4f, 0.2f));
    precompute({"--tolerance", "0.1", "--material", "ggx:albedo=0.2,f0=0.5,roughness=0.5"});
    EXPECT_NEAR(web_albedo(prt::load_scene(folder() / "scene.prt"))[0].g, 0.2 + 0.5 - 0.04, 1e-5)
        << "what is mirrored counts as colour";
    EXPECT_THAT(succeed("export web scene.prt -o site --samples 0").err,
                testing::Not(HasSubstr("left out: highlights")))
        << "the page finds them";
}

TEST_F(ExportWeb, SaysWhatItLeavesOut) {
    precompute({"--view", "auto", "--material", "ggx:roughness=0.5", "--tolerance", "0.1"});
    const auto run = succeed("export web scene.prt white.hdr -o site --samples 0");
    EXPECT_THAT(run.err, HasSubstr("left out: highlights, which are for one eye"));
    EXPECT_EQ(manifest()["leftOut"][0], "highlights, which are for one eye");
}

TEST_F(ExportWeb, SaysThatGlassIsOpaque) {
    write("glass.mtl", "newmtl glass\nKd 1 1 1\nd 0.5\n");
    write("glass.obj", "mtllib glass.mtl\nusemtl glass\n" + read("mesh.obj"));
    succeed(
        "precompute glass.obj -o scene.prt --tolerance 0.1 --refine off --face-resolution 32 -q");
    const auto run = succeed("export web scene.prt white.hdr -o site --samples 0");
    EXPECT_THAT(run.err, HasSubstr("left out: alpha and glass: surfaces are opaque"));
    EXPECT_EQ(manifest()["leftOut"][0],
              "alpha and glass: surfaces are opaque, though light passes them");
}

TEST_F(ExportWeb, RefusesInOneLineAndWritesNothing) {
    precompute({"--tolerance", "0.1"});
    const std::vector<std::string> fine = {"export", "web",  "scene.prt", "white.hdr",
                                           "-o",     "site", "--samples", "0"};
    std::filesystem::create_directory(folder() / "site");
    write("site/mine.txt", "mine");
    fail(fine, {"site: expected an empty folder, or one with a page"});
    EXPECT_FALSE(std::filesystem::exists(folder() / "site/index.html"));
    fail("export web scene.prt absent.hdr -o new", {"absent.hdr"});
    write("broken.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n1234");
    fail("export web scene.prt broken.hdr -o new", {"broken.hdr: "});
    fail("export web mesh.obj white.hdr -o new", {"mesh.obj: expected"});
    fail("export web scene.prt white.hdr -o mesh.obj", {"mesh.obj: expected a folder"});
    succeed("precompute mesh.obj -o pixels.prt --receivers pixels:8x8 --view auto --refine off "
            "--face-resolution 32 -q");
    fail("export web pixels.prt white.hdr -o new",
         {"pixels.prt: expected a scene of vertices, got one of pixels"});
    ::setenv("RELUMINE_WEB", (folder() / "nowhere").c_str(), 1);
    fail("export web scene.prt white.hdr -o new", {"the page's parts are not installed"});
    EXPECT_FALSE(std::filesystem::exists(folder() / "new"));
    ::setenv("RELUMINE_WEB", (folder() / "parts").c_str(), 1);
    std::filesystem::remove(folder() / "site/mine.txt");
    succeed(fine);
    write("site/mine.txt", "mine");
    succeed(fine);
    EXPECT_EQ(read("site/mine.txt"), "mine");
}

} // namespace
} // namespace relumine::app
