// `relumine env convert`, run as a user would.
#include <cmath>

#include <fmt/format.h>

#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

class EnvConvert : public AppTest {
protected:
    /// What six vertices at +X -X +Y -Y +Z -Z receive, luminance aside: the green channel.
    [[nodiscard]] std::vector<float> lit(const std::string& environment,
                                         const std::vector<std::string>& options = {}) const {
        std::vector<std::string> arguments = {"relight", "scene.prt", environment,
                                              "-o",      "lit.npy",   "-q"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        succeed(arguments);
        std::vector<float> values;
        for (const auto& value : npy_values(read("lit.npy")))
            values.push_back(value[1]);
        return values;
    }
    void make_scene() const {
        write("mesh.obj", octahedron_obj());
        succeed("precompute mesh.obj -o scene.prt --face-resolution 16 --refine off -q");
        write("lamp.hdr", lamp_hdr(32)); // a lamp at +X
    }
    static void expect_same(const std::vector<float>& expected, const std::vector<float>& got,
                            const std::string& what) {
        ASSERT_EQ(expected.size(), got.size());
        for (std::size_t i = 0; i < expected.size(); ++i)
            EXPECT_NEAR(got[i], expected[i], 0.01f * expected[0] + 1e-3f) << what << ' ' << i;
    }
};

TEST_F(EnvConvert, EveryLayoutLightsTheSame) {
    make_scene();
    const std::vector<float> expected = lit("lamp.hdr");
    EXPECT_GT(expected[0], 10.0f * std::abs(expected[1]) + 0.01f);
    for (const std::string layout :
         {"latlong", "cube", "strip", "cross", "hcross", "angular", "mirrorball", "octahedral"}) {
        for (const std::string extension : {"exr", "HDR"}) {
            if (extension == "HDR" && layout != "strip" && layout != "octahedral")
                continue;
            const std::string out = fmt::format("{}.{}", layout, extension);
            const auto report = succeed({"env", "convert", "lamp.hdr", "-o", out, "--to", layout,
                                         "--face-resolution", "32", "--json"})
                                    .json();
            EXPECT_NEAR(report["output"]["mean_radiance"][1].get<double>() /
                            report["input"]["mean_radiance"][1].get<double>(),
                        1.0, 2e-3)
                << out;
            expect_same(expected, lit(out, {"--layout", layout}), out);
        }
    }
}

TEST_F(EnvConvert, SixFilesInAndOut) {
    make_scene();
    succeed("env convert lamp.hdr -o sky_{face}.exr --face-resolution 32");
    for (const char* face : {"px", "nx", "py", "ny", "pz", "nz"})
        EXPECT_FALSE(read(fmt::format("sky_{}.exr", face)).empty()) << face;
    expect_same(lit("lamp.hdr"), lit("sky_{face}.exr"), "six files");
    EXPECT_EQ(succeed("info sky_{face}.exr --json").json()["layout"], "cube");
    succeed("env convert sky_{face}.exr -o back.exr");
    std::filesystem::remove(folder() / "sky_nz.exr");
    fail("info sky_{face}.exr", {"sky_nz.exr"});
    succeed("env convert lamp.hdr -o sky_nz.exr --to octahedral --size 31");
    fail("info sky_{face}.exr", {"sky_nz.exr", "32x32", "31x31"});
    fail("env convert sky_{face}.exr -o sky_px.exr", {"sky_px.exr", "input"});
}

TEST_F(EnvConvert, ConventionsThereAndBackLightTheSame) {
    make_scene();
    const std::vector<float> expected = lit("lamp.hdr");
    for (const std::string name :
         {"usd", "mitsuba", "blender", "threejs", "opengl", "directx", "pbrt"}) {
        succeed({"env", "convert", "lamp.hdr", "-o", "there.exr", "--to", name, "--face-resolution",
                 "32"});
        succeed({"env", "convert", "there.exr", "-o", "back.exr", "--from", name, "--to", "latlong",
                 "--size", "128"});
        expect_same(expected, lit("back.exr"), name);
    }
    // A wrong reading shows: Blender's middle is a quarter turn away from OpenEXR's.
    succeed("env convert lamp.hdr -o blender.exr --to blender");
    const std::vector<float> wrong = lit("blender.exr");
    EXPECT_LT(wrong[0], 0.1f * expected[0]);
    succeed("env convert blender.exr -o same.hdr --from blender");
    EXPECT_EQ(lit("same.hdr"), expected); // columns were moved, nothing else
}

// What lit the scene before is in the sun's file and the map without it, in whatever axes the map
// is written.
TEST_F(EnvConvert, SplitsTheSunOff) {
    make_scene();
    succeed("generate sun_sky -o . --face-resolution 64 -q");
    const std::vector<float> whole = lit("sun_sky.exr");
    for (const std::string to : {"openexr", "blender", "opengl"}) {
        const auto report = succeed({"env", "convert", "sun_sky.exr", "-o", "sky.exr", "--to", to,
                                     "--split-sun", "--json"})
                                .json();
        EXPECT_GT(report["sun"]["share_of_power"].get<double>(), 0.3);
        EXPECT_EQ(report["sun"]["file"], "sky.sun.json");
        succeed({"env", "convert", "sky.exr", "-o", "back.exr", "--from", to, "-q"});
        const std::vector<float> sky = lit("back.exr");
        succeed("relight mesh.obj --lights sky.sun.json -o sun.npy -q");
        const auto sun = npy_values(read("sun.npy"));
        ASSERT_EQ(sun.size(), whole.size());
        for (std::size_t i = 0; i < whole.size(); ++i)
            EXPECT_NEAR(sky[i] + sun[i][1], whole[i], 0.02f * whole[2]) << to << " vertex " << i;
    }
    write("white.hdr", white_hdr());
    fail("env convert white.hdr -o white.exr --split-sun",
         {"white.hdr: expected a sun to split off"});
}

TEST_F(EnvConvert, SaysWhatIsWrong) {
    write("env.hdr", white_hdr());
    write("square.hdr",
          hdr_file(32, 32, [](std::uint32_t, std::uint32_t) { return Rgb{1, 1, 1}; }));
    fail("env convert square.hdr -o out.exr", {"square.hdr", "--layout", "32x32"});
    succeed("env convert square.hdr -o ok.exr --from pbrt --to latlong --size 32");
    fail("env convert square.hdr -o out.exr --layout cross", {"square.hdr", "3:4"});
    fail("env convert env.hdr -o out.exr --from opengl", {"env.hdr", "cube", "opengl"});
    misuse("env convert env.hdr -o out.png",
           "--output: expected a name that ends in .exr or .hdr, got 'out.png'");
    misuse("env convert env.hdr -o out.exr --size 4294967297x1", "--size");
    fail("env convert env.hdr -o no/out.exr", {"no/out.exr"});
    fail("env convert missing.hdr -o out.exr", {"missing.hdr"});
    fail("env convert env.hdr -o env.hdr", {"env.hdr", "input"});
    misuse("env convert env.hdr -o out.exr --to maya", "maya");
    misuse("env convert env.hdr -o out.exr --to pbrt,cube", "octahedral");
    misuse("env convert env.hdr -o out.exr --from usd --layout cube", "latlong");
    misuse("env convert env.hdr -o out.exr --to fisheye", "fisheye");
    misuse("env convert env.hdr -o out_{face}.exr --to cross", "six files");
    for (const char* size : {"0", "-4", "12x", "x12", "64x33x1", "1e3", "99999999"})
        misuse({"env", "convert", "env.hdr", "-o", "out.exr", "--to", "cross", "--size", size},
               "--size");
    misuse("env convert env.hdr -o out.exr --to cross --size 64", "multiple of 3");
    misuse("env convert env.hdr -o out.exr --to cube --size 8x9", "8x9");
    misuse("env convert env.hdr -o out.exr --size 8 --face-resolution 8", "--face-resolution");
    misuse("env convert env.hdr -o out.exr --face-resolution 99999", "16384");
    misuse("env");
}

} // namespace
} // namespace relumine::app
