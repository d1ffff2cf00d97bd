// `relumine relight`: directions, options and what it refuses.
#include <algorithm>
#include <cmath>

#include <sys/stat.h>

#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

namespace fs = std::filesystem;

using Values = std::vector<std::array<float, 3>>;

/// Vertices of the octahedron.
enum Vertex { PlusX, MinusX, PlusY, MinusY, PlusZ, MinusZ };

class Relight : public AppTest {
protected:
    Relight() {
        write("mesh.obj", octahedron_obj());
        write("white.hdr", white_hdr());
        succeed("precompute mesh.obj -o scene.prt --face-resolution 32 -q --refine off");
    }
    /// Radiance of the six vertices.
    [[nodiscard]] Values lit(const std::string& environment,
                             const std::vector<std::string>& options = {}) const {
        std::vector<std::string> arguments = {"relight", "scene.prt", environment, "-o", "lit.npy"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        succeed(arguments);
        Values values = npy_values(read("lit.npy"));
        EXPECT_EQ(values.size(), 6u);
        values.resize(6);
        return values;
    }
    /// Refused as wrong usage or as a failure; either way in one line and with nothing left behind.
    void refuse(const std::vector<std::string>& options, int exit_code) const {
        std::vector<std::string> arguments = {"relight", "scene.prt", "white.hdr", "-o", "new.png"};
        if (std::find(options.begin(), options.end(), "--size") == options.end())
            arguments.insert(arguments.end(), {"--size", "8x8"});
        arguments.insert(arguments.end(), options.begin(), options.end());
        if (exit_code == 2)
            misuse(arguments);
        else
            fail(arguments);
    }
};

std::size_t brightest(const Values& values) {
    return static_cast<std::size_t>(
        std::max_element(values.begin(), values.end(),
                         [](const auto& a, const auto& b) { return a[0] < b[0]; }) -
        values.begin());
}

TEST_F(Relight, WhiteFurnace) {
    for (const auto& value : lit("white.hdr"))
        for (const float channel : value)
            EXPECT_NEAR(channel, 1.0f, 2e-3f);
}

TEST_F(Relight, AConfigOfOpenColorIOIsReadBeforeAnyWork) {
    refuse({"--ocio", "missing.ocio"}, 1);
    refuse({"--ocio", "missing.ocio,Film"}, 1);
    refuse({"--ocio", ",Film"}, 2);
    refuse({"--ocio", "missing.ocio,"}, 2);
    refuse({"--ocio", "missing.ocio", "--tone-map", "aces"}, 2);
}

TEST_F(Relight, LightComesFromWhereItIs) {
    const std::vector<std::pair<std::uint32_t, std::size_t>> columns = {
        {64, PlusZ}, {32, PlusX}, {96, MinusX}};
    for (const auto& [column, vertex] : columns) {
        write("lamp.hdr", lamp_hdr(column));
        const Values values = lit("lamp.hdr");
        EXPECT_EQ(brightest(values), vertex) << column;
        // pi / 64 square radians of radiance 512, seen face on; the neighbours see it edge on.
        const double side = 2.0 * 3.14159265 / 64.0;
        EXPECT_NEAR(values[vertex][0], 512.0 * side * side / 3.14159265, 0.03) << column;
        for (std::size_t other = 0; other < 6; ++other)
            EXPECT_LT(values[other][0], (other == vertex ? 1.01f : 0.05f) * values[vertex][0])
                << column << other;
    }
}

TEST_F(Relight, UpIsUp) {
    write("sky.hdr", hdr_file(64, 32, [](std::uint32_t, std::uint32_t y) {
              return y < 16 ? Rgb{1.0f, 2.0f, 4.0f} : Rgb{0.25f, 0.25f, 0.25f};
          }));
    const Values values = lit("sky.hdr");
    EXPECT_NEAR(values[PlusY][2], 4.0f, 0.02f);
    EXPECT_NEAR(values[PlusY][0], 1.0f, 0.02f);
    EXPECT_NEAR(values[MinusY][2], 0.25f, 0.02f);
    for (const std::size_t side : {PlusX, MinusX, PlusZ, MinusZ})
        EXPECT_NEAR(values[side][1], 1.125f, 0.03f);
}

TEST_F(Relight, RotateBy90TakesPlusZToPlusX) {
    write("ahead.hdr", lamp_hdr(64));
    write("left.hdr", lamp_hdr(32));
    const Values turned = lit("ahead.hdr", {"--rotate", "90"});
    EXPECT_EQ(brightest(turned), PlusX);
    EXPECT_LT(relative_l2(turned, lit("left.hdr")), 1e-3);
    EXPECT_EQ(brightest(lit("ahead.hdr", {"--rotate", "180"})), MinusZ);
    EXPECT_EQ(brightest(lit("ahead.hdr", {"--rotate", "-90"})), MinusX);
    EXPECT_EQ(brightest(lit("ahead.hdr", {"--rotate", "270"})), MinusX);
    EXPECT_LT(relative_l2(lit("ahead.hdr", {"--rotate", "360"}), lit("ahead.hdr")), 1e-3);
    EXPECT_LT(relative_l2(lit("ahead.hdr", {"--rotate", "450"}), turned), 1e-3);
}

TEST_F(Relight, RotationByAnyAngleKeepsTheLight) {
    write("lamp.hdr", lamp_hdr(64));
    const Values values = lit("lamp.hdr", {"--rotate", "30"});
    const float full = lit("lamp.hdr")[PlusZ][0];
    EXPECT_NEAR(values[PlusZ][0] / full, std::cos(30.0 * 3.14159265 / 180.0), 0.02);
    EXPECT_NEAR(values[PlusX][0] / full, std::sin(30.0 * 3.14159265 / 180.0), 0.02);
}

TEST_F(Relight, ExposureAndAlbedoAreFactors) {
    const Values plain = lit("white.hdr");
    const Values brighter = lit("white.hdr", {"--exposure", "2"});
    const Values darker = lit("white.hdr", {"--exposure", "-1"});
    const Values grey = lit("white.hdr", {"--albedo", "0.5"});
    const Values tinted = lit("white.hdr", {"--albedo", "1,0.5,0.25"});
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_FLOAT_EQ(brighter[i][0], 4.0f * plain[i][0]);
        EXPECT_FLOAT_EQ(darker[i][1], 0.5f * plain[i][1]);
        EXPECT_FLOAT_EQ(grey[i][2], 0.5f * plain[i][2]);
        EXPECT_FLOAT_EQ(tinted[i][0], plain[i][0]);
        EXPECT_FLOAT_EQ(tinted[i][2], 0.25f * plain[i][2]);
    }
}

TEST_F(Relight, ExposureSuitsThePictureAndIsSaid) {
    const auto out = [&](const std::string& name, const std::vector<std::string>& more) {
        std::vector<std::string> command = {"relight", "scene.prt", "white.hdr", "-o",
                                            name,      "--size",    "32x32"};
        command.insert(command.end(), more.begin(), more.end());
        return succeed(command);
    };
    // All of the octahedron shines with 0.5, and 0.8 is what the brightest parts get.
    const std::vector<std::string> alone = {"--background", "1"};
    const std::string picture = out("auto.png", alone).out;
    EXPECT_NE(picture.find("; exposure 0.68 (auto)\n"), std::string::npos) << picture;
    out("given.png", {"--background", "1", "--exposure", "0.68"});
    EXPECT_TRUE(read("auto.png") == read("given.png"));
    // A photograph behind comes out at 1.4 at most, and not darker than 0.18 where 0.6 stops do.
    EXPECT_NE(out("new.png", {}).out.find("; exposure 0.49 (auto)\n"), std::string::npos);
    EXPECT_NE(out("new.png", {"--albedo", "8"}).out.find("; exposure -2.72 (auto)\n"),
              std::string::npos);
    EXPECT_NE(out("new.png", {"--exposure", "-3"}).out.find("; exposure -3.00\n"),
              std::string::npos);
    EXPECT_NEAR(out("new.png", {"--json"}).json()["exposure"].get<double>(), 0.49, 1e-6);
    EXPECT_NEAR(out("new.glb", {"--json"}).json()["exposure"].get<double>(), 0.49, 1e-6);
    // Data are not touched.
    EXPECT_EQ(out("new.exr", {"--json"}).json()["exposure"], 0.0);
    const auto facts = out("new.npy", {"--json"}).json();
    EXPECT_EQ(facts["exposure"], 0.0);
    EXPECT_NE(facts["environment"], "") << "how the file was understood";
    EXPECT_EQ(out("new.npy", {}).out.find("exposure"), std::string::npos);
}

TEST_F(Relight, ToneMapsAreForPngOnly) {
    const auto bytes = [&](const std::string& name, const std::string& tone) {
        succeed({"relight", "scene.prt", "white.hdr", "-o", name, "--size", "32x32", "--exposure",
                 "1", "--tone-map", tone});
        return read(name);
    };
    const std::string neutral = bytes("new.png", "neutral");
    succeed("relight scene.prt white.hdr -o plain.png --size 32x32 --exposure 1");
    EXPECT_TRUE(read("plain.png") == neutral);
    for (const char* tone : {"agx", "aces", "none"}) {
        EXPECT_FALSE(bytes("new.png", tone) == neutral) << tone;
        EXPECT_TRUE(bytes("new.exr", tone) == bytes("new.exr", "neutral")) << tone;
    }
    refuse({"--tone-map", "reinhard"}, 2);
}

TEST_F(Relight, CameraByAngles) {
    const auto bytes = [&](const std::vector<std::string>& camera) {
        std::vector<std::string> command = {"relight",  "scene.prt", "white.hdr", "-o",
                                            "seen.exr", "--size",    "32x32"};
        command.insert(command.end(), camera.begin(), camera.end());
        succeed(command);
        return read("seen.exr");
    };
    EXPECT_TRUE(bytes({}) == bytes({"--camera", "24,20"}));
    EXPECT_TRUE(bytes({"--camera", "24,20"}) == bytes({"--camera", "24,20,,35"}));
    EXPECT_TRUE(bytes({"--camera", "24,20", "--fov", "60"}) == bytes({"--camera", "24,20,,60"}));
    EXPECT_FALSE(bytes({"--camera", "24,20"}) == bytes({"--camera", "24,20,9"}));
    EXPECT_TRUE(bytes({"--camera=0,0,5"}) == bytes({"--eye", "0,0,5", "--target", "0,0,0"}));
    for (const char* camera : {"1", "a,b", "1,2,3,4,5", "1,2,", "0,91", "0,0,-1", "0,0,0", "nan,0",
                               "0,0,,180", "0,0,5,0", ",1"})
        refuse({"--camera", camera}, 2);
    refuse({"--camera", "1,2", "--eye", "1,2,3"}, 2);
    refuse({"--camera", "1,2,,30", "--fov", "30"}, 2);
}

TEST_F(Relight, Backgrounds) {
    write("lamp.hdr", lamp_hdr(4)); // beside the octahedron
    const auto pixels = [&](const std::vector<std::string>& options) {
        std::vector<std::string> command = {"relight", "scene.prt", "lamp.hdr", "-o",   "new.exr",
                                            "--size",  "32x32",     "--camera", "0,0,9"};
        command.insert(command.end(), options.begin(), options.end());
        succeed(command);
        return read("new.exr");
    };
    EXPECT_TRUE(pixels({}) == pixels({"--background", "sharp"}));
    EXPECT_FALSE(pixels({}) == pixels({"--background", "blur=20"}));
    EXPECT_FALSE(pixels({}) == pixels({"--background", "0.5"}));
    EXPECT_TRUE(pixels({"--background", "0.5,0.5,0.5"}) == pixels({"--background", "0.5"}));
    // A channel more.
    EXPECT_GT(pixels({"--background", "none"}).size(), pixels({"--background", "0"}).size());
    for (const char* background : {"red", "blur", "blur=", "blur=0", "blur=181", "1,2", "-1", ""})
        refuse({"--background", background}, 2);
}

TEST_F(Relight, AlbedoOfTheMeshIsItsVertexColours) {
    write("red.obj", "v 0 0 0 1 0 0\nv 1 0 0 0.5 0.5 0.5\nv 0 0 -1 0 0 1\nf 1 2 3\n");
    succeed("precompute red.obj -o red.prt --face-resolution 16 --refine off");
    succeed("relight red.prt white.hdr -o red.npy --albedo mesh");
    const Values values = npy_values(read("red.npy"));
    ASSERT_EQ(values.size(), 3u);
    EXPECT_NEAR(values[0][0], 1.0f, 2e-3f);
    EXPECT_EQ(values[0][1], 0.0f);
    EXPECT_NEAR(values[1][1], 0.21404f, 2e-3f) << "sRGB";
    EXPECT_EQ(values[2][0], 0.0f);
    const Result said = succeed({"precompute", "red.obj", "-o", "red.prt", "--face-resolution",
                                 "16", "--refine", "off", "--vertex-colors", "linear"});
    EXPECT_EQ(said.out.find("colours are taken"), std::string::npos) << said.described();
    succeed({"relight", "red.prt", "white.hdr", "-o", "red.npy", "--albedo", "mesh"});
    EXPECT_NEAR(npy_values(read("red.npy"))[1][1], 0.5f, 2e-3f);
    misuse("relight scene.prt white.hdr -o new.npy --albedo mesh",
           "--albedo: expected a mesh with vertex colours");
}

TEST_F(Relight, PictureHasTheSizeAskedFor) {
    for (const char* size : {"1x1", "7x5", "300x2"}) {
        const std::vector<std::string> arguments = {"relight", "scene.prt", "white.hdr", "-o",
                                                    "lit.png", "--size",    size};
        succeed(arguments);
        const Size got = png_size(read("lit.png"));
        EXPECT_EQ(std::to_string(got.width) + "x" + std::to_string(got.height), size);
    }
    succeed(
        "relight scene.prt white.hdr -o lit.exr --size 20x10 --eye 3,1,2 --target 0,0,0 --fov 60");
    EXPECT_EQ(exr_size(read("lit.exr")), (Size{20, 10}));
}

TEST_F(Relight, BadOptionsAreRefused) {
    for (const char* size : {"abc", "10", "10x", "x10", "10x10x10", "10X10", "1e2x5", "10x10 ", ""})
        refuse({"--size", size}, 2);
    for (const char* size : {"0x0", "0x5", "16385x1", "99999x99999"})
        refuse({"--size", size}, 2);
    for (const char* vector :
         {"1,2", "1,2,3,4", "a,b,c", "1;2;3", "nan,0,0", "0,inf,0", "1,2,", ","}) {
        refuse({"--eye", vector}, 2);
        refuse({"--target", vector}, 2);
    }
    refuse({"--eye", "1,1,1", "--target", "1,1,1"}, 1);
    for (const char* fov : {"0", "180", "-10", "nan", "inf"})
        refuse({"--fov", fov}, 2);
    for (const char* albedo : {"red", "1,2", "nan", "inf", "1,2,3,4", "Mesh"})
        refuse({"--albedo", albedo}, 2);
    refuse({"--layout", "fisheye"}, 2);
    refuse({"--face-resolution", "-1"}, 2);
    refuse({"--face-resolution", "3.5"}, 2);
    for (const char* resolution : {"16385", "4000000000"})
        refuse({"--face-resolution", resolution}, 2);
    refuse({"--rotate", "north"}, 2);
    refuse({"--exposure", "bright"}, 2);
}

TEST_F(Relight, NumbersThatCannotBeMeantAreRefused) {
    const auto refused = [&](const std::string& option, const std::string& value) {
        const std::vector<std::string> before = files();
        const Result result =
            relumine({"relight", "scene.prt", "white.hdr", "-o", "new.npy", option, value});
        EXPECT_TRUE(result.exit_code == 1 || result.exit_code == 2) << option << value << '\n'
                                                                    << result.described();
        EXPECT_NE(result.err.find(option.substr(2)), std::string::npos) << result.described();
        EXPECT_EQ(files(), before) << option << value;
    };
    for (const char* value : {"nan", "inf", "-inf"}) {
        refused("--rotate", value);
        refused("--exposure", value);
    }
    refused("--exposure", "1e9");
    refused("--albedo", "-1");
    refused("--albedo", "1,1,-0.5");
}

TEST_F(Relight, UnknownKindsOfOutputAreRefused) {
    for (const char* name :
         {"new.bmp", "new", "new.prt", "new.npy.bak", ".", "..", ".npy", "sub/new.npy/"})
        misuse({"relight", "scene.prt", "white.hdr", "-o", name},
               "--output: expected a name that ends in .png, .exr, .ply, .glb or .npy, got");
}

TEST_F(Relight, OutputsThatCannotBeWrittenAreFoundOutAndNothingIsLost) {
    fail("relight scene.prt white.hdr -o missing/new.npy", {"missing/new.npy", "cannot write"});
    fail("relight scene.prt white.hdr -o scene.prt/new.npy", {"scene.prt/new.npy", "cannot write"});
    fail("relight scene.prt white.hdr -o /proc/new.npy", {"/proc/new.npy", "cannot write"});
    fail({"relight", "scene.prt", "white.hdr", "-o", std::string(300, 'a') + ".npy"},
         {"cannot write"});
    fs::create_directory(folder() / "folder.npy");
    fail("relight scene.prt white.hdr -o folder.npy", {"folder.npy", "cannot write"});
}

TEST_F(Relight, AFullDiskLeavesTheOldFile) {
    for (const char* name : {"old.npy", "old.png", "old.exr", "old.ply", "old.glb"}) {
        write(name, "precious");
        fail({"relight", "scene.prt", "white.hdr", "-o", name, "--size", "64x64"},
             {name, "cannot write"},
             {.max_file_bytes = 150}); // room for the message, which is a file here
    }
}

TEST_F(Relight, InputsAreNotOverwritten) {
    succeed("generate constant -o . --face-resolution 8 -q");
    fail("relight scene.prt constant.exr -o constant.exr", {"constant.exr"});
    fail("relight scene.prt constant.exr -o ./constant.exr", {"constant.exr"});
    fs::create_symlink("constant.exr", folder() / "link.exr");
    fail("relight scene.prt link.exr -o constant.exr", {"constant.exr"});
    fail("relight scene.prt constant.exr -o link.exr", {"link.exr"});
}

TEST_F(Relight, OnlyPlainFilesAreReplaced) {
    ASSERT_EQ(::mkfifo((folder() / "pipe.npy").c_str(), 0600), 0);
    fail("relight scene.prt white.hdr -o pipe.npy", {"pipe.npy"});
}

TEST_F(Relight, InputsThatCannotBeReadAreNamed) {
    fail("relight missing.prt white.hdr -o new.npy", {"missing.prt", "cannot read"});
    fail("relight scene.prt missing.hdr -o new.npy", {"missing.hdr", "cannot read"});
    fail("relight . white.hdr -o new.npy", {"cannot read"});
    fail("relight scene.prt . -o new.npy", {"cannot read"});
    fail("relight scene.prt /dev/zero -o new.npy", {"/dev/zero", "not a regular file"});
    ASSERT_EQ(::mkfifo((folder() / "pipe.hdr").c_str(), 0600), 0);
    fail("relight scene.prt pipe.hdr -o new.npy", {"pipe.hdr"});
}

TEST_F(Relight, AMeshIsPrecomputedOnceAndKept) {
    const auto first_picture = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments = {"relight", "mesh.obj", "white.hdr", "-o",
                                              "lit.png", "--size",   "96x72"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return succeed(arguments).out.find("kept in cache") != std::string::npos;
    };
    const auto num_kept = [&] {
        return fs::exists(folder() / "cache")
                   ? std::distance(fs::directory_iterator(folder() / "cache"),
                                   fs::directory_iterator())
                   : 0;
    };
    // Options that do not suit the scene are refused before anything is drawn.
    fail("relight mesh.obj white.hdr -o lit.png --albedo mesh", {"--albedo", "vertex colours"});
    EXPECT_FALSE(fs::exists(folder() / "lit.png"));
    EXPECT_TRUE(first_picture({}));
    EXPECT_EQ(num_kept(), 1);
    const std::string picture = read("lit.png");
    EXPECT_FALSE(first_picture({}));
    EXPECT_EQ(read("lit.png"), picture);
    // It is the scene that the options of precompute make by themselves, with a floor.
    succeed("precompute mesh.obj --floor -o own.prt -q");
    succeed("relight own.prt white.hdr -o own.png --size 96x72 -q");
    EXPECT_EQ(read("own.png"), picture);
    // Other commands take the same scene.
    for (const char* command :
         {"edit mesh.obj white.hdr -o other.npy --disc 0,1,0,10 --gain 2",
          "animate mesh.obj white.hdr -o other.%02d.png --turntable 2 --size 32x32",
          "verify mesh.obj white.hdr --samples 5"})
        EXPECT_EQ(succeed(command).out.find("kept in cache"), std::string::npos) << command;
    EXPECT_EQ(num_kept(), 1);
    write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    ::setenv("RELUMINE_CACHE", "", 1);
    EXPECT_FALSE(first_picture({}));
    ::setenv("RELUMINE_CACHE", "cache", 1);
    EXPECT_EQ(num_kept(), 1);
    EXPECT_NE(read("lit.png"), picture);
    write("broken.ply", "ply\nformat ascii 1.0\n");
    fail("relight broken.ply white.hdr -o lit.png", {"broken.ply"});
}

TEST_F(Relight, AFirstSightComesBeforeThePrecompute) {
    write("lamp.hdr", lamp_hdr(32));
    const char* const command = "relight mesh.obj lamp.hdr -o lit.png --size 64x48";
    const std::string said = succeed(command).out;
    EXPECT_NE(said.find("lit.png: a first sight"), std::string::npos) << said;
    EXPECT_LT(said.find("a first sight"), said.find("kept in cache"));
    const std::string picture = read("lit.png");
    // The scene is there now. Numbers and meshes have no sight.
    EXPECT_EQ(succeed(command).out.find("a first sight"), std::string::npos);
    EXPECT_EQ(read("lit.png"), picture);
    fs::remove_all(folder() / "cache");
    EXPECT_EQ(succeed("relight mesh.obj lamp.hdr -o lit.npy").out.find("first sight"),
              std::string::npos);
}

TEST_F(Relight, AnotherKindOfFileIsToldApart) {
    misuse("relight white.hdr scene.prt -o new.npy",
           "SCENE: expected a scene, got the environment white.hdr: the scene stands first");
    fail("relight scene.prt mesh.obj -o new.npy", {"mesh.obj", "expected"});
    fail("relight scene.prt scene.prt -o new.npy", {"scene.prt", "expected"});
}

TEST_F(Relight, DamagedScenesAreRefused) {
    const std::string whole = read("scene.prt");
    for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 25) {
        write("short.prt", whole.substr(0, size));
        fail("relight short.prt white.hdr -o new.npy", {"short.prt"});
    }
    write("short.prt", whole.substr(0, whole.size() - 1));
    fail("relight short.prt white.hdr -o new.npy", {"short.prt"});
    write("long.prt", whole + "x");
    fail("relight long.prt white.hdr -o new.npy", {"long.prt"});
    // docs/prt-format.md: the version is a little-endian number at byte 12.
    std::string newer = whole;
    newer[12] = 77;
    write("newer.prt", newer);
    fail("relight newer.prt white.hdr -o new.npy", {"newer.prt", "version", "77"});
    fail("info newer.prt", {"newer.prt", "version", "77"});
    fail("verify newer.prt white.hdr", {"newer.prt", "version", "77"});
    std::string flipped = whole;
    flipped[whole.size() / 2] = static_cast<char>(flipped[whole.size() / 2] ^ 4);
    write("flipped.prt", flipped);
    fail("relight flipped.prt white.hdr -o new.npy", {"flipped.prt"});
}

TEST_F(Relight, AnEnvironmentAndALightListAreAdded) {
    write("lamp.hdr", lamp_hdr(32));
    succeed("lights lamp.hdr -n 1 -o lamp.json");
    const auto read_lit = [&](const std::vector<std::string>& light) {
        std::vector<std::string> arguments = {"relight", "scene.prt", "-o", "lit.npy"};
        arguments.insert(arguments.end(), light.begin(), light.end());
        succeed(arguments);
        return npy_values(read("lit.npy"));
    };
    const Values sky = read_lit({"white.hdr"}), lamp = read_lit({"--lights", "lamp.json"}),
                 both = read_lit({"white.hdr", "--lights", "lamp.json"});
    EXPECT_GT(lamp[PlusX][0], 0.0f);
    for (std::size_t i = 0; i < both.size(); ++i)
        for (std::size_t channel = 0; channel < 3; ++channel)
            EXPECT_FLOAT_EQ(both[i][channel], sky[i][channel] + lamp[i][channel]);
    misuse("relight scene.prt -o lit.npy");
}

TEST_F(Relight, FlipAndTiltTurnTheEnvironment) {
    write("lamp.hdr", lamp_hdr(64)); // +Z
    EXPECT_EQ(brightest(lit("lamp.hdr")), PlusZ);
    EXPECT_EQ(brightest(lit("lamp.hdr", {"--flip", "z"})), MinusZ);
    EXPECT_EQ(brightest(lit("lamp.hdr", {"--flip", "y"})), PlusZ);
    EXPECT_EQ(brightest(lit("lamp.hdr", {"--tilt", "-90"})), PlusY);
    EXPECT_EQ(brightest(lit("lamp.hdr", {"--tilt", "-90", "--rotate", "90"})), PlusY);
    EXPECT_EQ(brightest(lit("lamp.hdr", {"--tilt", "180", "--rotate", "90"})), MinusX);
    // The middle of pbrt-v2's lat-long is -X.
    EXPECT_EQ(brightest(lit("lamp.hdr", {"--from", "pbrt-v2"})), MinusX);
    refuse({"--flip", "up"}, 2);
    refuse({"--from", "pbrt-v2", "--layout", "cube"}, 2);
}

TEST_F(Relight, AGroundBrighterThanTheSkyIsDoubted) {
    write("lamp.hdr", lamp_hdr(64)); // +Z
    const auto warnings = [&](const std::string& environment, const std::string& option,
                              const std::string& value) {
        return succeed({"relight", "scene.prt", environment, option, value, "-o", "lit.npy"}).err;
    };
    EXPECT_EQ(warnings("lamp.hdr", "--tilt", "-90"), "");
    const std::string below = warnings("lamp.hdr", "--tilt", "90");
    EXPECT_NE(below.find("lamp.hdr: brighter below than above"), std::string::npos) << below;
    EXPECT_NE(below.find("--flip y"), std::string::npos);
    EXPECT_NE(succeed("env convert lamp.hdr -o down.exr --tilt 90").err.find("--flip y"),
              std::string::npos);
    EXPECT_NE(succeed("info down.exr").out.find("--flip y"), std::string::npos);
    EXPECT_EQ(succeed("info down.exr --json").json()["upside_down"], true);
    EXPECT_EQ(warnings("down.exr", "--flip", "y"), "");
    // A map whose sun lies beside it is darker above, and stands upright all the same.
    write("down.sun.json", "{}");
    EXPECT_EQ(warnings("down.exr", "--rotate", "0"), "");
    EXPECT_EQ(succeed("info down.exr").out.find("--flip y"), std::string::npos);
    EXPECT_EQ(succeed("info down.exr --json").json()["upside_down"], false);
}

} // namespace
} // namespace relumine::app
