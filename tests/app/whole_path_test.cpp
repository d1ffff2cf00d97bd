// From nothing to a lit picture, the way the README goes.

#include <fmt/format.h>

#include "tests/app/command.h"
#include "tests/app/formats.h"

namespace relumine::app {
namespace {

namespace fs = std::filesystem;

class WholePath : public AppTest {
protected:
    /// A scene file of about `num_vertices` vertices.
    nlohmann::json precompute(const std::string& scene, int num_vertices,
                              const std::string& tolerance = "0.03") const {
        succeed({"generate", scene, "-o", ".", "--vertices", std::to_string(num_vertices), "-q"});
        return succeed({"precompute", scene + ".ply", "--refine", "off", "-o", "scene.prt",
                        "--tolerance", tolerance, "--face-resolution", "64", "--json"})
            .json();
    }
    void generate(const std::string& environment, int resolution,
                  const std::string& where = ".") const {
        succeed({"generate", environment, "-o", where, "--face-resolution",
                 std::to_string(resolution), "-q"});
    }
};

TEST_F(WholePath, GeneratePrecomputeInfoRelightEditVerify) {
    const nlohmann::json made = precompute("knot", 1200);
    for (const char* key : {"vertices", "triangles", "clusters", "samples", "rays", "seconds",
                            "peak_bytes", "file_bytes"}) {
        ASSERT_TRUE(made.contains(key)) << key;
        EXPECT_GT(made[key], 0) << key;
    }
    EXPECT_NEAR(made["vertices"].get<double>(), 1200.0, 80.0);
    EXPECT_EQ(made["file_bytes"], fs::file_size(folder() / "scene.prt"));
    EXPECT_GE(made["samples"], made["rays"]);
    EXPECT_LT(made["peak_bytes"], 500'000'000ll * SanitizerFactor);

    const nlohmann::json info = succeed("info scene.prt --json").json();
    EXPECT_EQ(info["kind"], "scene");
    for (const char* key : {"vertices", "triangles", "clusters", "file_bytes"})
        EXPECT_EQ(info[key], made[key]) << key;
    EXPECT_EQ(info["source"], "knot.ply");
    EXPECT_EQ(info["face_resolution"], 64);

    generate("soft_boxes", 32);
    const auto vertices = made["vertices"].get<std::size_t>();
    const auto triangles = made["triangles"].get<std::size_t>();
    for (const char* name : {"lit.png", "lit.exr", "lit.ply", "lit.glb", "lit.npy"}) {
        const nlohmann::json lit = succeed({"relight", "scene.prt", "soft_boxes.exr", "-o", name,
                                            "--size", "40x30", "--json"})
                                       .json();
        for (const char* key :
             {"seconds_load", "seconds_resample", "seconds_bin", "seconds_relight"}) {
            ASSERT_TRUE(lit.contains(key)) << key;
            EXPECT_GE(lit[key], 0.0) << key;
            EXPECT_LT(lit[key], 10.0) << key;
        }
    }
    EXPECT_EQ(png_size(read("lit.png")), (Size{40, 30}));
    EXPECT_EQ(exr_size(read("lit.exr")), (Size{40, 30}));
    EXPECT_EQ(ply_element(read("lit.ply"), "vertex"), vertices);
    EXPECT_EQ(ply_element(read("lit.ply"), "face"), triangles);
    const nlohmann::json gltf = glb_json(read("lit.glb"));
    const nlohmann::json& primitive = gltf["meshes"][0]["primitives"][0];
    EXPECT_EQ(gltf["accessors"][primitive["attributes"]["COLOR_0"].get<std::size_t>()]["count"],
              vertices);
    EXPECT_EQ(
        gltf["accessors"][primitive["attributes"]["COLOR_0"].get<std::size_t>()]["componentType"],
        5126);
    EXPECT_EQ(gltf["accessors"][primitive["indices"].get<std::size_t>()]["count"], 3 * triangles);
    const auto lit = npy_values(read("lit.npy"));
    EXPECT_EQ(lit.size(), vertices);

    // The lit mesh is a mesh again, with its colours.
    const nlohmann::json ply = succeed("info lit.ply --json").json();
    EXPECT_EQ(ply["vertices"], vertices);
    EXPECT_EQ(ply["colors"], true);

    const nlohmann::json edit = succeed("edit scene.prt soft_boxes.exr -o edited.npy "
                                        "--disc 0,1,0,20 --gain 3 --save-env edited.exr --json")
                                    .json();
    EXPECT_GT(edit["clusters_touched"], 0);
    EXPECT_LT(edit["clusters_touched"], edit["clusters"]);
    // What an edit leaves is what the edited environment gives.
    succeed("relight scene.prt edited.exr -o again.npy");
    const auto edited = npy_values(read("edited.npy"));
    EXPECT_LT(relative_l2(edited, npy_values(read("again.npy"))), 2e-3);
    EXPECT_GT(relative_l2(edited, lit), 0.01);

    const nlohmann::json verified =
        succeed("verify scene.prt soft_boxes.exr --samples 100 --json").json();
    EXPECT_EQ(verified["samples"], 100);
    EXPECT_LT(verified["relative_l2"], 0.02);
    EXPECT_LE(verified["mean_abs"], verified["max_abs"]);
}

TEST_F(WholePath, ErrorIsSmallUnderEveryGeneratedEnvironment) {
    precompute("blob", 1000, "0.0135");
    for (const char* name : {"sun_sky", "soft_boxes", "small_light", "constant"}) {
        generate(name, 64);
        for (const char* file : {"", "_latlong"}) {
            const nlohmann::json error =
                succeed({"verify", "scene.prt", fmt::format("{}{}.exr", name, file), "--samples",
                         "100", "--json"})
                    .json();
            EXPECT_LT(error["relative_l2"], 0.02) << name << file;
            EXPECT_GT(error["mean_radiance"], 0.0) << name << file;
        }
    }
}

TEST_F(WholePath, OneSceneFileServesEveryResolutionOfTheEnvironment) {
    precompute("colonnade", 1500);
    for (const char* name : {"64", "256", "1024"}) {
        generate("soft_boxes", std::stoi(name), name);
        succeed({"relight", "scene.prt", fmt::format("{}/soft_boxes.exr", name), "-o",
                 fmt::format("{}.npy", name)});
    }
    const auto finest = npy_values(read("1024.npy"));
    EXPECT_LT(relative_l2(npy_values(read("64.npy")), finest), 0.01);
    EXPECT_LT(relative_l2(npy_values(read("256.npy")), finest), 0.01);
}

TEST_F(WholePath, TheSunKeepsItsLightAtEveryResolution) {
    precompute("blob", 1000);
    for (const char* name : {"16", "64", "256"}) {
        generate("sun_sky", std::stoi(name), name);
        succeed({"relight", "scene.prt", fmt::format("{}/sun_sky_latlong.exr", name), "-o",
                 fmt::format("{}.npy", name)});
    }
    // A sun of half a degree is spread over a texel of 1.4 degrees at R = 64: shadow edges move,
    // the light stays.
    const auto mean = [&](const std::string& name) {
        double sum = 0.0;
        const auto values = npy_values(read(name));
        for (const auto& value : values)
            sum += static_cast<double>(value[1]) / static_cast<double>(values.size());
        return sum;
    };
    EXPECT_NEAR(mean("16.npy") / mean("256.npy"), 1.0, 0.01);
    EXPECT_NEAR(mean("64.npy") / mean("256.npy"), 1.0, 0.005);
}

TEST_F(WholePath, ThreadsDoNotChangeABit) {
    succeed("generate knot -o . --vertices 1500 -q");
    generate("sun_sky", 32);
    for (const std::string threads : {"1", "2"}) {
        const auto name = [&](const char* end) {
            return fmt::format("{}{}", threads, end);
        };
        const auto run = [&](std::vector<std::string> arguments) {
            arguments.insert(arguments.end(), {"--threads", threads});
            succeed(arguments);
        };
        run({"precompute", "knot.ply", "-o", name(".prt"), "--floor", "20", "--tolerance", "0.03",
             "--face-resolution", "64"});
        run({"relight", name(".prt"), "sun_sky.exr", "-o", name(".npy")});
        run({"edit", name(".prt"), "sun_sky.exr", "-o", name("e.npy"), "--disc", "1,1,0,10"});
        run({"relight", name(".prt"), "sun_sky.exr", "-o", name(".png"), "--size", "32x24"});
    }
    for (const char* file : {".prt", ".npy", "e.npy", ".png"})
        EXPECT_TRUE(read(fmt::format("1{}", file)) == read(fmt::format("2{}", file))) << file;
}

} // namespace
} // namespace relumine::app
