// `relumine coarsen`: all kinds of scenes, and what is refused.
#include <cmath>
#include <filesystem>
#include <vector>

#include <gmock/gmock.h>

#include "prt/scene/scene_file.h"
#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

class Coarsen : public AppTest {
protected:
    Coarsen() {
        write("mesh.obj", octahedron_obj());
        write("white.hdr", white_hdr());
        write("lamp.hdr", lamp_hdr(40));
    }

    void precompute(const std::vector<std::string>& options) {
        std::vector<std::string> arguments = {
            "precompute",        "mesh.obj", "-o",       "scene.prt", "--floor", "17",
            "--face-resolution", "256",      "--refine", "off",       "-q"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        succeed(arguments);
    }

    /// Coarsens the scene, and compares its light with that of the scene itself: relative L2.
    void expect_the_same_light(const std::vector<std::string>& options, double most_apart,
                               const std::string& tolerance = "0.1") {
        const nlohmann::json report =
            succeed({"coarsen", "scene.prt", "--tolerance", tolerance, "-o", "small.prt", "--json"})
                .json();
        EXPECT_LT(report["clusters"], report["clusters_before"]);
        EXPECT_EQ(report["bytes"], std::filesystem::file_size(folder() / "small.prt"));
        succeed("info small.prt --check -q");
        std::vector<std::vector<Rgb>> light;
        for (const char* scene : {"scene.prt", "small.prt"}) {
            std::vector<std::string> arguments = {
                "relight", scene, "white.hdr", "-o", "light.npy", "--clusters-only", "-q"};
            arguments.insert(arguments.end(), options.begin(), options.end());
            succeed(arguments);
            light.push_back(npy_values(read("light.npy")));
        }
        ASSERT_EQ(light[0].size(), light[1].size());
        double difference = 0.0, sum = 0.0;
        for (std::size_t i = 0; i < light[0].size(); ++i) {
            difference += std::pow(double{light[1][i][1]} - light[0][i][1], 2);
            sum += std::pow(light[0][i][1], 2);
        }
        EXPECT_LE(std::sqrt(difference / sum), most_apart);
    }
};

TEST_F(Coarsen, KeepsTheLightOfVertices) {
    precompute({"--tolerance", "0.02"});
    expect_the_same_light({}, 2e-3);
}

TEST_F(Coarsen, KeepsBouncesAndMaterials) {
    precompute({"--tolerance", "0.02", "--bounces", "0.05", "--material", "lambert:albedo=0.5"});
    expect_the_same_light({"--bounces", "3"}, 2e-3);
    EXPECT_TRUE(prt::load_scene(folder() / "small.prt").bounces);
}

TEST_F(Coarsen, KeepsPixelsAndTheirHighlights) {
    precompute({"--tolerance", "0.02", "--receivers", "pixels:24x16", "--view", "auto",
                "--highlights", "stored", "--material", "ggx:roughness=0.5"});
    expect_the_same_light({}, 5e-3);
    const prt::Scene fine = prt::load_scene(folder() / "scene.prt");
    const prt::Scene coarse = prt::load_scene(folder() / "small.prt");
    ASSERT_TRUE(fine.transfer.glossy && coarse.transfer.glossy);
    EXPECT_TRUE(coarse.receivers.surfaces == fine.receivers.surfaces);
}

TEST_F(Coarsen, KeepsTexels) {
    write("mesh.obj", "v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nv 0 0.5 -1\nv 0 0.5 1\n"
                      "vt 0 0\nvt 0.5 0\nvt 0.5 1\nvt 0 1\nvt 1 1\nvt 1 0\n"
                      "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\nf 6/6 5/5 3/3\n");
    precompute({"--tolerance", "0.02", "--receivers", "texels:12x12"});
    expect_the_same_light({}, 5e-3);
}

TEST_F(Coarsen, KeepsPoints) {
    precompute({"--tolerance", "0.05", "--receivers", "grid:4x4x4:-2,1.5,-2,2,3,2"});
    expect_the_same_light({}, 1e-2, "0.2");
}

TEST_F(Coarsen, ChangesNoByteAtTheSameTolerance) {
    precompute({"--tolerance", "0.05"});
    succeed("coarsen scene.prt --tolerance 0.05 -o same.prt");
    EXPECT_EQ(read("same.prt"), read("scene.prt"));
}

TEST_F(Coarsen, RefusesInOneLine) {
    precompute({"--tolerance", "0.05"});
    fail("coarsen scene.prt --tolerance 0.02 -o small.prt",
         {"scene.prt: made with --tolerance 0.05"});
    fail("coarsen mesh.obj --tolerance 0.1 -o small.prt", {"mesh.obj: expected"});
    fail("coarsen absent.prt --tolerance 0.1 -o small.prt", {"absent.prt"});
    fail("coarsen scene.prt --tolerance 0.1 -o scene.prt", {"scene.prt"});
    misuse("coarsen scene.prt --tolerance 0.1 -o small.relight", "--output");
    misuse("coarsen scene.prt --tolerance nan -o small.prt", "--tolerance");
    misuse("coarsen scene.prt --tolerance 0.1", "--output");
    EXPECT_FALSE(std::filesystem::exists(folder() / "small.prt"));
}

} // namespace
} // namespace relumine::app
