// Points in space and grids: `relumine precompute --receivers points:FILE`, `relumine relight
// --harmonics FILE`.
#include <cmath>

#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

class PointsCommand : public AppTest {
protected:
    PointsCommand() {
        write("mesh.obj", octahedron_obj());
        write("white.hdr", white_hdr());
        // A .ply without faces: far above, near, and in the octahedron.
        write("points.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty "
                            "float y\nproperty float z\nend_header\n0 50 0\n0 1.5 0\n0.1 0 0\n");
    }
    Result precompute(const std::string& receivers, const std::vector<std::string>& options = {},
                      const std::string& output = "scene.prt") const {
        std::vector<std::string> arguments = {"precompute",  "mesh.obj", "-o", output,
                                              "--receivers", receivers,  "-v"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        return succeed(arguments);
    }
};

TEST_F(PointsCommand, HaveTheMeanRadianceOfTheirSphere) {
    const Result result = precompute("points:points.ply");
    EXPECT_NE(result.out.find("1 of 3 points lie inside of objects"), std::string::npos)
        << result.described();
    succeed("relight scene.prt white.hdr -o lit.npy --harmonics sh.npy -q");
    const auto values = npy_values(read("lit.npy"));
    ASSERT_EQ(values.size(), 3u);
    EXPECT_NEAR(values[0][1], 1.0f, 1e-3f);
    // The octahedron hides a part of the sphere, and the point inside looks from the near one.
    EXPECT_GT(values[1][1], 0.8f);
    EXPECT_LT(values[1][1], 0.98f);
    EXPECT_EQ(values[2], values[1]);
    const auto light = npy_values(read("sh.npy"));
    ASSERT_EQ(light.size(), 3u * 9u);
    EXPECT_NEAR(light[0][0], 2.0 * std::sqrt(3.14159265), 4e-3);
    EXPECT_GT(light[10][0], 0.05f); // dark where the octahedron is: below
}

TEST_F(PointsCommand, GridsFillTheirBoxAndBecomePicturesAndProbes) {
    precompute("grid:3x2x2:-3,2,-3,3,4,3");
    const auto info = succeed("info scene.prt --json").json();
    EXPECT_EQ(info.at("layout").at("kind"), "grid") << info;
    EXPECT_EQ(info.at("layout").at("nx"), 3);
    succeed("relight scene.prt white.hdr -o lit.exr --harmonics sh.exr -q");
    EXPECT_EQ(exr_size(read("lit.exr")), (Size{3, 4}));
    const auto channels = exr_channels(folder() / "sh.exr");
    ASSERT_TRUE(channels.contains("L2p2.B"));
    EXPECT_EQ(channels.at("L1m1.G").size(), 12u);
    succeed("relight scene.prt white.hdr -o lit.png --harmonics sh.json -q");
    const auto probes = nlohmann::json::parse(read("sh.json")).at("object");
    EXPECT_EQ(probes.at("type"), "Group");
    ASSERT_EQ(probes.at("children").size(), 12u);
    const auto& first = probes.at("children").at(0);
    EXPECT_EQ(first.at("type"), "LightProbe");
    ASSERT_EQ(first.at("sh").size(), 27u);
    EXPECT_FLOAT_EQ(first.at("matrix").at(12).get<float>(), -2.0f);
    EXPECT_FLOAT_EQ(first.at("matrix").at(13).get<float>(), 2.5f);
    EXPECT_FLOAT_EQ(first.at("matrix").at(14).get<float>(), -1.5f);
}

TEST_F(PointsCommand, PartsAndThreadsMakeTheSameBytes) {
    // Cells of 16 x 16 on each face, because eight runs take their time.
    const std::vector<std::string> how = {"mesh.obj",          "--receivers", "grid:16x8x10",
                                          "--face-resolution", "16",          "-q"};
    const auto with = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.begin() + 1, how.begin(), how.end());
        return arguments;
    };
    succeed(with({"precompute", "-o", "one.prt", "--threads", "1"}));
    succeed(with({"precompute", "-o", "two.prt", "--threads", "2"}));
    EXPECT_EQ(read("one.prt"), read("two.prt"));

    succeed(with({"plan", "-o", "scene.plan"}));
    succeed("precompute scene.plan --part 1/1 -o all.part -q");
    succeed("join all.part -o all.prt -q");
    for (const char* part : {"1", "2"})
        succeed({"precompute", "scene.plan", "--part", std::string(part) + "/2", "-o",
                 std::string(part) + ".part", "-q"});
    succeed("join 1.part 2.part -o joined.prt -q");
    EXPECT_EQ(read("all.prt"), read("joined.prt"));

    succeed("relight one.prt white.hdr -o whole.npy --harmonics a.npy -q --threads 1");
    succeed("relight one.prt white.hdr -o again.npy --harmonics b.npy -q");
    EXPECT_EQ(read("a.npy"), read("b.npy"));
    for (const char* part : {"1", "2"})
        succeed({"relight", "one.prt", "white.hdr", "--part", std::string(part) + "/2", "-o",
                 std::string(part) + ".lit", "-q"});
    succeed("join 1.lit 2.lit -o parts.npy -q");
    EXPECT_EQ(read("parts.npy"), read("whole.npy"));
}

TEST_F(PointsCommand, PartsOfAFileOfPointsMakeTheSameBytes) {
    // More points than two tiles of 1,024, so that three parts have something to share.
    std::string ply = "ply\nformat ascii 1.0\nelement vertex 2600\nproperty float x\nproperty "
                      "float y\nproperty float z\nend_header\n";
    for (int i = 0; i < 2600; ++i)
        ply += std::to_string(0.11 * (i % 20) - 1.1) + " " + std::to_string(0.2 * (i / 200)) + " " +
               std::to_string(0.3 * (i / 20 % 10) - 1.5) + "\n";
    write("many.ply", ply);
    succeed("plan mesh.obj -o scene.plan --receivers points:many.ply --face-resolution 16 -q");
    for (const int count : {1, 3}) {
        std::vector<std::string> join = {"join"};
        for (int i = count; i >= 1; --i) {
            join.push_back(std::to_string(i) + ".part");
            succeed({"precompute", "scene.plan", "--part",
                     std::to_string(i) + "/" + std::to_string(count), "-o", join.back(), "-q"});
        }
        join.insert(join.end(), {"-o", std::to_string(count) + ".prt", "-q"});
        succeed(join);
    }
    EXPECT_EQ(read("1.prt"), read("3.prt"));
}

TEST_F(PointsCommand, AnEnvironmentIsFittedToPoints) {
    precompute("grid:4x4x4:-3,2,-3,3,4,3");
    write("lamp.hdr", lamp_hdr(40));
    succeed("relight scene.prt lamp.hdr -o lit.npy --clusters-only -q");
    const auto report =
        succeed("fit scene.prt lit.npy -o env.exr --face-resolution 8 --json").json();
    EXPECT_LT(report["relative_l2"], 0.005);
    fail("fit scene.prt lit.npy --lights 1 -o lamp.json", {"points in space"});
}

TEST_F(PointsCommand, GetTheLightThatSurfacesSend) {
    precompute("points:points.ply", {"--bounces", "0.02", "--refine", "off"});
    const auto info = succeed("info scene.prt --json").json();
    EXPECT_EQ(info.at("receivers"), 3) << info;
    const auto lit = [&](const std::vector<std::string>& options) {
        std::vector<std::string> arguments = {"relight", "scene.prt", "white.hdr",   "-o",
                                              "lit.npy", "--json",    "--harmonics", "sh.npy"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        return succeed(arguments).json();
    };
    EXPECT_EQ(lit({"--bounces", "0"}).at("receivers"), 3);
    const auto direct = npy_values(read("lit.npy")), dark = npy_values(read("sh.npy"));
    // One octahedron alone is convex: its faces send the sky's light once, times their albedo.
    lit({"--albedo", "0.5"});
    const auto all = npy_values(read("lit.npy")), light = npy_values(read("sh.npy"));
    ASSERT_EQ(all.size(), 3u);
    ASSERT_EQ(light.size(), 3u * 9u);
    EXPECT_NEAR(all[0][1], 1.0f, 1e-3f);
    EXPECT_NEAR(all[1][1], 0.5f * (1.0f + direct[1][1]), 0.02f);
    EXPECT_LT(light[10][1], 0.7f * dark[10][1]); // from below
    EXPECT_NEAR(0.282095f * light[9][1], all[1][1], 1e-5f);
    EXPECT_EQ(all[2], all[1]);
    // Backwards, too.
    const auto fitted =
        succeed("fit scene.prt lit.npy -o env.exr --face-resolution 4 --json").json();
    EXPECT_LT(fitted["relative_l2"], 0.01);
}

TEST_F(PointsCommand, VerticesHaveHarmonicsToo) {
    succeed("precompute mesh.obj -o scene.prt -q --refine off");
    succeed("relight scene.prt white.hdr -o lit.npy --harmonics sh.npy -q");
    const auto light = npy_values(read("sh.npy"));
    ASSERT_EQ(light.size(), 6u * 9u);
    // The irradiance of vertex +X along its normal, c0 Y0 pi + c3 Y3 2 pi / 3 + (c6 Y6 + c8 Y8)
    // pi / 4, is that of its radiance.
    const auto radiance = npy_values(read("lit.npy"));
    EXPECT_NEAR(radiance[0][0], 1.0, 2e-3);
    EXPECT_NEAR(0.886227 * light[0][0] + 1.023328 * light[3][0] - 0.247708 * light[6][0] +
                    0.429043 * light[8][0],
                3.14159265 * radiance[0][0], 1e-5);
    misuse("relight scene.prt white.hdr -o x.png --harmonics sh.exr", "--harmonics");
}

TEST_F(PointsCommand, BadInput) {
    const auto refuse = [&](const std::string& receivers, const std::string& part,
                            const std::vector<std::string>& options = {}) {
        std::vector<std::string> arguments = {"precompute", "mesh.obj",    "-o",
                                              "new.prt",    "--receivers", receivers};
        arguments.insert(arguments.end(), options.begin(), options.end());
        misuse(arguments, part);
    };
    refuse("grid:0x2x2", "expected a grid of 1 to");
    refuse("grid:2x2", "grid:NXxNYxNZ");
    refuse("grid:20000x1x1", "expected a grid of 1 to");
    refuse("points:points.txt", ".npy or .ply");
    refuse("grid:2x2x2:1,0,0,0,1,1", "the lower corner first");
    refuse("grid:2x2x2:1,0,0", "X0,Y0,Z0,X1,Y1,Z1");
    refuse("grid:2x2x2:0,0,0,1,1,1:2", "grid:NXxNYxNZ");
    refuse("grid:2x2x2", "--view", {"--view", "auto"});
    refuse("grid:2x2x2", "--bounces", {"--bounces", "-1"});
    write("nan.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                     "property float z\nend_header\n0 nan 0\n");
    fail("precompute mesh.obj -o new.prt --receivers points:nan.ply",
         {"nan.ply: expected points with finite coordinates, got (0, nan, 0)"});
    fail("precompute mesh.obj -o new.prt --receivers points:none.npy", {"none.npy"});
    precompute("points:points.ply", {"-q"});
    misuse("relight scene.prt white.hdr -o x.png --harmonics sh.png", "--harmonics");
    misuse("relight scene.prt white.hdr -o x.ply", "--output");
}

} // namespace
} // namespace relumine::app
