// `relumine lights`: what it writes and what it refuses.
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

using testing::HasSubstr;

class Lights : public AppTest {
protected:
    Lights() {
        write("white.hdr", white_hdr());
        write("lamp.hdr", lamp_hdr(32));
    }
};

TEST_F(Lights, WritesAListWhoseLightsAddUpToTheMap) {
    for (const std::string method : {"median-cut", "variance", "importance"}) {
        const auto report = succeed({"lights", "white.hdr", "-n", "16", "--method", method, "-o",
                                     "lights.json", "--json"})
                                .json();
        EXPECT_EQ(report["lights"], 16);
        EXPECT_EQ(report["method"], method);
        const auto list = nlohmann::json::parse(read("lights.json"));
        EXPECT_EQ(list["version"], 1);
        EXPECT_EQ(list["environment"], "white.hdr");
        EXPECT_EQ(list["method"], method);
        EXPECT_EQ(list.contains("seed"), method == "importance");
        ASSERT_EQ(list["lights"].size(), 16u);
        double sum = 0.0;
        for (const auto& light : list["lights"])
            sum += light["irradiance"][1].get<double>();
        EXPECT_NEAR(sum, 4.0 * std::numbers::pi, 1e-9);
        EXPECT_NEAR(report["power"][1].get<double>(), sum, 1e-12);
    }
}

TEST_F(Lights, FindsTheLamp) {
    // Column 32 of 128 is +X.
    succeed("lights lamp.hdr -n 1 -o lamp.json");
    const auto light = nlohmann::json::parse(read("lamp.json"))["lights"][0];
    EXPECT_NEAR(light["direction"][0].get<double>(), 1.0, 1e-3);
    // Turned by 90 degrees it comes from -Z (+Z goes to +X, +X to -Z), and as a cube map it keeps
    // its power.
    succeed("lights lamp.hdr -n 1 -o turned.json --rotate 90");
    const auto turned = nlohmann::json::parse(read("turned.json"))["lights"][0];
    EXPECT_NEAR(turned["direction"][2].get<double>(), -1.0, 1e-3);
    EXPECT_NEAR(turned["irradiance"][0].get<double>() / light["irradiance"][0].get<double>(), 1.0,
                1e-6);
}

TEST_F(Lights, EveryFormatByExtensionOrName) {
    for (const std::string file :
         {"a.json", "a.csv", "a.pbrt", "a.xml", "a.usda", "a.py", "a.gltf"})
        succeed({"lights", "lamp.hdr", "-n", "4", "-o", file});
    EXPECT_THAT(read("a.csv"), testing::StartsWith("# 4 distant lights of lamp.hdr, variance"));
    EXPECT_THAT(read("a.pbrt"), HasSubstr("LightSource \"distant\""));
    EXPECT_THAT(read("a.xml"), HasSubstr("<emitter type=\"directional\">"));
    EXPECT_THAT(read("a.usda"), testing::StartsWith("#usda 1.0"));
    EXPECT_THAT(read("a.py"), HasSubstr("import bpy"));
    EXPECT_EQ(nlohmann::json::parse(read("a.gltf"))["nodes"].size(), 4u);
    succeed("lights lamp.hdr -n 4 -o soft.usda --soft");
    EXPECT_NE(read("soft.usda"), read("a.usda"));
}

TEST_F(Lights, DrawsThePicture) {
    succeed("lights lamp.hdr -n 8 --picture regions.png");
    EXPECT_EQ(png_size(read("regions.png")), (Size{1024, 512}));
    succeed("lights lamp.hdr -n 8 --picture regions.exr -o l.json");
    EXPECT_EQ(exr_size(read("regions.exr")), (Size{1024, 512}));
}

TEST_F(Lights, RepeatsItself) {
    const auto list = [&](const std::vector<std::string>& options) {
        std::vector<std::string> arguments = {"lights",   "white.hdr",  "-n", "20",
                                              "--method", "importance", "-o", "l.json"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        succeed(arguments);
        return read("l.json");
    };
    const std::string first = list({});
    EXPECT_EQ(list({"--threads", "1"}), first);
}

TEST_F(Lights, RefusesWhatItCannotDo) {
    fail("lights white.hdr -n 2049 -o l.json",
         {"white.hdr: expected 1 to 2048 lights for 64 x 32 pixels, got 2049"});
    misuse("lights white.hdr -o l.txt", "--output: expected a name that ends in .json, .csv");
    fs::create_symlink("white.hdr", folder() / "l.csv");
    fail("lights white.hdr -o l.csv", {"expected an output other than the input"});
    misuse("lights white.hdr --picture l.jpg",
           "--picture: expected a name that ends in .png or .exr, got 'l.jpg'");
    fail("lights white.hdr -o missing/l.json", {"missing/l.json"});
    fail("lights none.hdr -o l.json", {"none.hdr"});
    write("nan.exr", exr_file(8, 4, [](std::uint32_t x, std::uint32_t) {
              return Rgb{x == 3 ? NAN : 1.0f, 1.0f, 1.0f};
          }));
    fail("lights nan.exr -o l.json", {"nan.exr"});
    succeed("lights nan.exr -n 2 -o fixed.json --fix-env");

    misuse("lights white.hdr -n 0 -o l.json", "--number");
    misuse("lights white.hdr -n -4 -o l.json", "--number");
    misuse("lights white.hdr -n many -o l.json", "--number");
    misuse("lights white.hdr --method best -o l.json", "best");
    misuse("lights white.hdr", "-o or --picture");
}

TEST_F(Lights, ABlackMapGivesBlackLights) {
    write("black.hdr",
          hdr_file(16, 8, [](std::uint32_t, std::uint32_t) { return Rgb{0.0f, 0.0f, 0.0f}; }));
    const auto report = succeed("lights black.hdr -n 128 -o l.json --picture l.png --json").json();
    EXPECT_EQ(report["power"][0], 0.0);
    EXPECT_EQ(report["lights"], 128);
}

TEST_F(Lights, ChosenForASceneAndItsErrorSaid) {
    write("mesh.obj", octahedron_obj());
    succeed("precompute mesh.obj -o scene.prt --face-resolution 16 --refine off -q");
    const auto transfer =
        succeed("lights lamp.hdr -n 4 --method transfer --scene scene.prt -o lights.json --json")
            .json();
    EXPECT_LE(transfer["lights"].get<int>(), 4);
    EXPECT_LT(transfer["relative_l2"].get<double>(), 0.05);
    const Result said = succeed("lights lamp.hdr -n 4 --scene scene.prt -o lights.json");
    EXPECT_THAT(said.out, HasSubstr("% relative L2 on this asset"));
    // Materials change what is reflected, not what arrives: the lights and their error are the
    // same.
    succeed("precompute mesh.obj -o grey.prt --face-resolution 16 -q --material lambert:albedo=0.3 "
            "--refine off");
    const auto of_grey =
        succeed("lights lamp.hdr -n 4 --method transfer --scene grey.prt -o lights.json --json")
            .json();
    EXPECT_EQ(of_grey["lights"], transfer["lights"]);
    EXPECT_EQ(of_grey["relative_l2"], transfer["relative_l2"]);
    EXPECT_THAT(succeed("lights lamp.hdr -n 1 -o lights.json").out, HasSubstr("1 light by"));
    misuse("lights lamp.hdr --method transfer -o lights.json",
           "expected --scene SCENE.prt with transfer");
    misuse("lights lamp.hdr -n 1,2 -o a.json");
}

// The lamp's one light gives what the lamp gives, traced, through the clusters, and on the mesh
// alone.
TEST_F(Lights, LightASceneOrAMesh) {
    write("mesh.obj", octahedron_obj());
    succeed("precompute mesh.obj -o scene.prt --face-resolution 16 --refine off -q");
    succeed("lights lamp.hdr -n 1 -o lamp.json");
    const auto lit = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.end(), {"-o", "lit.npy", "-q"});
        succeed(arguments);
        return npy_values(read("lit.npy"));
    };
    const auto expected = lit({"relight", "scene.prt", "lamp.hdr"});
    for (const auto& radiance :
         {lit({"relight", "scene.prt", "--lights", "lamp.json"}),
          lit({"relight", "scene.prt", "--lights", "lamp.json", "--clusters-only"}),
          lit({"relight", "mesh.obj", "--lights", "lamp.json"})}) {
        ASSERT_EQ(radiance.size(), expected.size());
        for (std::size_t i = 0; i < expected.size(); ++i)
            EXPECT_NEAR(radiance[i][1], expected[i][1], 0.02f * expected[0][1]) << i;
    }
}

TEST_F(Lights, RelightingWithThemSaysWhatIsWrong) {
    write("mesh.obj", octahedron_obj());
    succeed("lights lamp.hdr -n 1 -o lamp.json");
    misuse("relight mesh.obj -o a.npy", "expected ENV, --lights or both");
    fail("relight mesh.obj --lights lamp.json --clusters-only -o a.npy",
         {"mesh.obj: expected a scene file with --clusters-only"});
    write("bad.json",
          R"({"version": 1, "lights": [{"direction": [0, 1, 0], "irradiance": [1, -1, 1]}]})");
    fail("relight mesh.obj --lights bad.json -o a.npy", {"bad.json:1"});
}

TEST_F(Lights, AListIsWrittenInEveryFormat) {
    succeed("lights lamp.hdr -n 4 -o list.json");
    for (const std::string file :
         {"a.json", "a.csv", "a.pbrt", "a.xml", "a.usda", "a.py", "a.gltf"}) {
        succeed({"lights", "lamp.hdr", "-n", "4", "-o", "direct_" + file});
        EXPECT_EQ(succeed({"lights", "list.json", "-o", file, "--json"}).json()["lights"], 4);
        EXPECT_EQ(read(file), read("direct_" + file)) << file;
    }
    misuse("lights list.json --picture a.png");
}

TEST_F(Lights, FormatsWithoutASizeSayThatSoftLightsAreLost) {
    for (const auto& [file, holds] :
         {std::pair{"a.usda", true}, std::pair{"a.py", true}, std::pair{"a.json", true},
          std::pair{"a.pbrt", false}, std::pair{"a.xml", false}, std::pair{"a.gltf", false}}) {
        const auto result = succeed({"lights", "white.hdr", "-n", "2", "--soft", "-o", file});
        EXPECT_EQ(result.err.find("--soft has no effect") == std::string::npos, holds) << file;
    }
}

} // namespace
} // namespace relumine::app
