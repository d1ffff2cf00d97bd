// `relumine edit`: what it changes and what it refuses.
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <thread>

#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

class Edit : public AppTest {
protected:
    Edit() {
        write("mesh.obj", octahedron_obj());
        write("white.hdr", white_hdr());
        succeed("precompute mesh.obj -o scene.prt --face-resolution 32 -q --refine off");
    }
    [[nodiscard]] static std::vector<std::string> command(const std::vector<std::string>& options) {
        std::vector<std::string> arguments = {"edit", "scene.prt", "white.hdr", "-o", "new.npy"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        return arguments;
    }
};

TEST_F(Edit, BrightensTheSideThatFacesTheDisc) {
    const nlohmann::json report =
        succeed(command({"--disc", "1,0,0,20", "--gain", "4,2,1", "--json"})).json();
    for (const char* key : {"clusters_touched", "clusters", "seconds_edit", "seconds_full"})
        EXPECT_TRUE(report.contains(key)) << key;
    const auto values = npy_values(read("new.npy"));
    ASSERT_EQ(values.size(), 6u);
    // +X sees the disc face on: 1 + (gain - 1) sin(20 degrees)^2; the texels' rim costs some.
    EXPECT_NEAR(values[0][0], 1.0 + 3.0 * 0.117, 0.05);
    EXPECT_NEAR(values[0][1], 1.0 + 1.0 * 0.117, 0.02);
    EXPECT_NEAR(values[0][2], 1.0, 5e-3);
    EXPECT_NEAR(values[1][0], 1.0, 5e-3) << "-X does not see it";
    for (const std::size_t side : {2u, 3u, 4u, 5u})
        EXPECT_LT(values[side][0], values[0][0]) << side;
}

TEST_F(Edit, GainZeroAndAWholeSphereTurnTheLightOff) {
    succeed(command({"--disc", "0,1,0,180", "--gain", "0"}));
    for (const auto& value : npy_values(read("new.npy")))
        // The point opposite is the disc's rim; the coverage of the texel it lies in is good to 0.5
        // %.
        EXPECT_NEAR(value[0], 0.0f, 1e-4f);
}

TEST_F(Edit, TheSavedEnvironmentGivesTheSame) {
    for (const char* name : {"new.exr", "new.hdr"}) {
        succeed(command({"--disc", "0,1,1,10", "--gain", "8", "--save-env", name}));
        succeed({"relight", "scene.prt", name, "-o", "again.npy"});
        EXPECT_LT(relative_l2(npy_values(read("again.npy")), npy_values(read("new.npy"))), 5e-3)
            << name;
    }
}

TEST_F(Edit, BadOptionsAreRefused) {
    for (const char* disc :
         {"0,0,0,10", "up", "0,1", "0,1,0", "0,1,0,0", "nan,0,0,10", "inf,0,0,10"})
        misuse(command({"--disc", disc}), "--disc");
    for (const char* gain : {"nan", "inf", "-1", "1,2", "1,2,-3", "much"})
        misuse(command({"--disc", "0,1,0,10", "--gain=" + std::string(gain)}), "--gain");
    for (const char* radius : {"nan", "-1", "181", "wide", "inf"})
        misuse(command({"--disc", "0,1,0," + std::string(radius)}), "--disc");
    misuse("edit scene.prt white.hdr -o new.bmp --disc 0,1,0,10", "new.bmp");
}

TEST_F(Edit, ABadSavedEnvironmentIsFoundOutBeforeAnythingIsWritten) {
    for (const char* name : {"saved.txt", "saved", "new.npy", "."})
        misuse(command({"--disc", "0,1,0,10", "--save-env", name}), "--save-env");
    for (const char* name : {"missing/saved.exr", "/proc/saved.exr"})
        fail(command({"--disc", "0,1,0,10", "--save-env", name}), {name});
    fail(command({"--disc", "0,1,0,10", "--save-env", "white.hdr"}), {"white.hdr"});
    fail("edit scene.prt white.hdr -o same.exr --size 8x8 --disc 0,1,0,10 --save-env ./same.exr",
         {"same.exr"});
}

TEST_F(Edit, GainBeyondWhatAFloatHoldsIsRefused) {
    misuse(command({"--disc", "0,1,0,10", "--gain", "3e38"}), "--gain");
    misuse(command({"--disc", "0,1,0,10", "--gain", "1e39"}), "--gain");
}

constexpr const char* Lamp = R"({"version": 1, "layers": [
  {"name": "lamp", "type": "disc", "direction": [1, 0, 0], "radius_degrees": 30, "effect": "emit", "radiance": [4, 2, 0]},
  {"name": "fill", "type": "disc", "direction": [-1, 0, 0], "radius_degrees": 90, "effect": "gain", "factor": 0.5}],
  "frames": [{"frame": 1, "layers": {"lamp": {"gain_ev": 0}}}, {"frame": 3, "layers": {"lamp": {"gain_ev": 2}}}]})";

TEST_F(Edit, LayersAreAppliedOneByOneAndEachTellsItsCost) {
    std::string still = Lamp;
    still = still.substr(0, still.find("],\n  \"frames\"")) + "]}";
    write("layers.json", still);
    const nlohmann::json report =
        succeed("edit scene.prt white.hdr layers.json -o new.npy --json").json();
    ASSERT_EQ(report["edits"].size(), 2u);
    EXPECT_EQ(report["edits"][0]["name"], "lamp");
    EXPECT_LT(report["edits"][0]["clusters"], report["clusters"]);
    EXPECT_GT(report["edits"][1]["receivers"], 0);
    // The octahedron's corner on +X sees 1 + 4 sin(30 degrees)^2 = 2, the one on -X half of the
    // white.
    const auto values = npy_values(read("new.npy"));
    EXPECT_NEAR(values[0][0], 2.0, 0.02);
    EXPECT_NEAR(values[0][1], 1.5, 0.015);
    EXPECT_NEAR(values[0][2], 1.0, 0.01);
    EXPECT_NEAR(values[1][0], 0.5, 0.01);
}

TEST_F(Edit, TheRotationOfTheFileTurnsEnvironmentAndLayers) {
    std::string still = Lamp;
    still = still.substr(0, still.find("],\n  \"frames\"")) + "]}";
    write("layers.json", still);
    succeed("edit scene.prt white.hdr layers.json -o still.npy");
    write("turned.json", "{\"rotate_degrees\": 90, " + still.substr(1));
    succeed("edit scene.prt white.hdr turned.json -o turned.npy");
    const auto before = npy_values(read("still.npy")), after = npy_values(read("turned.npy"));
    for (std::size_t channel = 0; channel < 3; ++channel) {
        EXPECT_NEAR(after[5][channel], before[0][channel], 1e-3); // +X to -Z
        EXPECT_NEAR(after[4][channel], before[1][channel], 1e-3); // -X to +Z
    }
}

TEST_F(Edit, FramesBecomeNumberedFiles) {
    write("layers.json", Lamp);
    succeed("edit scene.prt white.hdr layers.json -o frame.%03d.npy");
    for (const auto& [name, gain] :
         {std::pair{"frame.001.npy", 1.0}, {"frame.002.npy", 2.0}, {"frame.003.npy", 4.0}})
        EXPECT_NEAR(npy_values(read(name))[0][0], 1.0 + gain, 0.01 * (1.0 + gain)) << name;
    misuse("edit scene.prt white.hdr layers.json -o frame.%s.npy",
           "--output: expected a place for the frame's number");
}

TEST_F(Edit, WhoShowsTheLightOfThatPoint) {
    write("layers.json", Lamp);
    succeed("edit scene.prt white.hdr layers.json --who 1,0,0 -o who.exr");
    const nlohmann::json map = succeed("info who.exr --json").json();
    EXPECT_GT(map["brightest_direction"][0], 0.85);
    // Its integral over the sphere is the point's radiance.
    EXPECT_NEAR(map["mean_radiance"][0].get<double>() * 4.0 * 3.14159265, 2.0, 0.03);
    succeed("edit scene.prt white.hdr layers.json --who 1,0,0 -o who.png");
    EXPECT_EQ(read("who.png").substr(1, 3), "PNG");
    // The lamp is the only light, and on the other side.
    write("black.hdr",
          hdr_file(64, 32, [](std::uint32_t, std::uint32_t) { return Rgb{0.0f, 0.0f, 0.0f}; }));
    EXPECT_NE(succeed("edit scene.prt black.hdr --disc 0,1,0,10 --who 1,0,0 -o who.png")
                  .err.find("who.png: black, since no light reaches vertex"),
              std::string::npos);
}

TEST_F(Edit, LitByShowsWhatARegionLights) {
    // A disc of 30 degrees: sin(30 degrees)^2 of the white light on the corner that faces it,
    // nothing on the other side.
    const nlohmann::json disc =
        succeed(
            "edit scene.prt white.hdr --disc 0,1,0,10 --gain 1 --lit-by 1,0,0,30 -o new.npy --json")
            .json();
    EXPECT_NEAR(npy_values(read("new.npy"))[0][0], 0.25, 0.01);
    EXPECT_EQ(npy_values(read("new.npy"))[1][0], 0.0f);
    EXPECT_GT(disc["lit_by_share"], 0.01);
    EXPECT_LT(disc["lit_by_share"], 0.25);

    // A layer's region, with the light of the layers in it.
    write("layers.json", Lamp);
    const auto lit_by = [&](const std::string& region, const std::string& output) {
        succeed({"edit", "scene.prt", "white.hdr", "layers.json", "--lit-by", region, "-o", output,
                 "-q"});
    };
    lit_by("1,0,0,40", "new.npy"); // the lamp's 30 degrees and a ring of white around it
    const auto values = npy_values(read("new.npy"));
    EXPECT_NEAR(values[0][0], 0.413 + 4.0 * 0.25, 0.02);
    EXPECT_NEAR(values[0][1], 0.413 + 2.0 * 0.25, 0.02);
    EXPECT_NEAR(values[0][2], 0.413, 0.01);
    EXPECT_EQ(values[1][0], 0.0f);
    lit_by("1,0,0,30", "new.npy");
    lit_by("lamp", "named.npy");
    EXPECT_EQ(read("named.npy"), read("new.npy"));
    lit_by("lamp", "new.png");
    EXPECT_EQ(read("new.png").substr(1, 3), "PNG");
    lit_by("lamp", "new.ply");

    for (const char* bad :
         {"nobody", "1,0,0", "0,0,0,10", "1,0,0,0", "1,0,0,181", "1,0,0,x", "1,0,0,nan", ","})
        misuse({"edit", "scene.prt", "white.hdr", "layers.json", "--lit-by", bad, "-o", "bad.npy"},
               "--lit-by");
    misuse("edit scene.prt white.hdr layers.json --lit-by lamp --who 1,0,0 -o bad.exr", "--who");
    EXPECT_FALSE(std::filesystem::exists(folder() / "bad.npy"));
}

TEST_F(Edit, KeepsTheExposureOfTheLightBefore) {
    const auto exposure = [&](const std::string& command) {
        return succeed((command + " -o new.png --size 32x32 --json").c_str()).json()["exposure"];
    };
    const std::string brighter = " --disc 0,1,0,40 --gain 50";
    const nlohmann::json before = exposure("relight scene.prt white.hdr");
    EXPECT_EQ(exposure("edit scene.prt white.hdr" + brighter), before);
    EXPECT_EQ(exposure("edit scene.prt white.hdr --lit-by 0,1,0,40" + brighter), before);
    EXPECT_EQ(exposure("edit scene.prt white.hdr --exposure 1" + brighter), 1.0);
    // Over nothing, what is added is all there is.
    write("black.hdr",
          hdr_file(64, 32, [](std::uint32_t, std::uint32_t) { return Rgb{0.0f, 0.0f, 0.0f}; }));
    write("layers.json", R"({"version": 1, "layers": [{"name": "lamp", "type": "disc",
        "direction": [1, 0, 0], "radius_degrees": 30, "effect": "emit", "radiance": [4, 2, 0]}]})");
    EXPECT_GT(exposure("edit scene.prt black.hdr layers.json"), before);
}

/// The mixer's layers as a compositor reads them: channels by name.
TEST_F(Edit, TheMixersLayersAddUpToThePicture) {
    write("mixed.json", R"({"version": 1, "layers": [
        {"name": "key.1", "preset": "softbox", "direction": [1, 1, 1], "kelvin": 3200, "exposure": 3},
        {"name": "muted", "on": false, "preset": "ring", "direction": [0, 1, 1]},
        {"name": "flag", "preset": "flag", "direction": [1, 1, 1]},
        {"name": "environment", "preset": "bulb", "direction": [-1, 1, 1]}]})");
    const std::vector<std::string> edit = {"edit",   "scene.prt", "white.hdr",  "mixed.json",
                                           "--size", "64x48",     "--exposure", "1"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), edit.begin(), edit.end());
        return more;
    };
    succeed(with({"--mixer", "-o", "mix.exr"}));
    succeed(with({"-o", "whole.exr"}));
    const auto mix = exr_channels(folder() / "mix.exr"),
               whole = exr_channels(folder() / "whole.exr");
    ASSERT_EQ(whole.size(), 3u);
    ASSERT_EQ(mix.size(), 15u) << "the picture, environment, key_1, flag, environment 2";
    double key = 0.0, flag = 0.0;
    for (const std::string channel : {"R", "G", "B"}) {
        ASSERT_EQ(mix.at(channel).size(), 64u * 48u);
        for (std::size_t i = 0; i < 64 * 48; ++i) {
            float sum = 0.0f;
            for (const char* layer : {"environment", "key_1", "flag", "environment 2"})
                sum += mix.at(std::string(layer) + "." + channel)[i];
            const float expected = whole.at(channel)[i];
            ASSERT_NEAR(sum, expected, 1e-4f * (1.0f + expected)) << channel << i;
            ASSERT_NEAR(mix.at(channel)[i], expected, 1e-4f * (1.0f + expected)) << channel << i;
            key += mix.at("key_1." + channel)[i];
            flag += mix.at("flag." + channel)[i];
        }
    }
    EXPECT_GT(key, 1.0);
    EXPECT_LT(flag, 0.0) << "it takes light away";

    misuse(with({"--mixer", "-o", "mix.png"}), "--output");
    misuse(with({"--mixer", "--who", "1,0,0", "-o", "mix2.exr"}), "--mixer");
}

TEST_F(Edit, WhoIsAPictureAndAsksForAPoint) {
    write("layers.json", Lamp);
    misuse("edit scene.prt white.hdr layers.json --who 1,0,0 -o who.npy",
           "--output: expected a name that ends in .exr or .png, got 'who.npy'");
    misuse("edit scene.prt white.hdr layers.json --who here -o who.exr", "--who");
}

TEST_F(Edit, BrokenLayersAreRefusedWithTheirLine) {
    write("broken.json",
          "{\n\"version\": 1,\n\"layers\": [\n{\"name\": \"a\", \"type\": \"disk\"}]}");
    fail("edit scene.prt white.hdr broken.json -o new.npy", {"broken.json:4: expected"});
    write("cut.json", "{\"version\": 1, \"layers\": [\n");
    fail("edit scene.prt white.hdr cut.json -o new.npy", {"cut.json:"});
    misuse("edit scene.prt white.hdr -o new.npy", "LAYERS");
}

TEST_F(Edit, WatchFollowsWhatAnotherProgramSaves) {
    write("layers.json", "{\"version\": 1, \"layers\": []}");
    Process process(folder(), {"edit", "scene.prt", "white.hdr", "layers.json", "-o", "new.npy",
                               "--watch", "--json"});
    const auto first_value = [&] {
        try {
            return npy_values(read("new.npy"))[0][0];
        } catch (const std::exception&) { // not there yet
            return -1.0f;
        }
    };
    const auto becomes = [&](float expected) {
        for (int i = 0; i < 4000; ++i) {
            if (std::abs(first_value() - expected) < 0.02f * expected)
                return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(25));
        }
        return false;
    };
    EXPECT_TRUE(becomes(1.0f));
    // Once in place, once by renaming over it, once as something that is no picture.
    std::this_thread::sleep_for(std::chrono::milliseconds(300)); // until it watches
    write("white.hdr",
          hdr_file(64, 32, [](std::uint32_t, std::uint32_t) { return Rgb{4.0f, 4.0f, 4.0f}; }));
    EXPECT_TRUE(becomes(4.0f));
    write("white.hdr", "half written");
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    write("other.hdr",
          hdr_file(64, 32, [](std::uint32_t, std::uint32_t) { return Rgb{2.0f, 2.0f, 2.0f}; }));
    std::filesystem::rename(folder() / "other.hdr", folder() / "white.hdr");
    EXPECT_TRUE(becomes(2.0f));
    process.send(SIGINT);
    const Result result = process.wait();
    EXPECT_EQ(result.exit_code, 0) << result.described();
    EXPECT_EQ(result.err.rfind("relumine: white.hdr: expected ", 0), 0u) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    const nlohmann::json edits = result.json()["edits"];
    ASSERT_EQ(edits.size(), 2u) << "one for each save";
    for (const nlohmann::json& edit : edits) {
        EXPECT_GT(edit["clusters"], 0);
        EXPECT_GT(edit["seconds_load"], 0.0);
        EXPECT_GE(edit["seconds_reaction"], 0.0);
        EXPECT_LT(edit["seconds_reaction"], 60.0) << "the file's clock and ours agree";
    }
}

} // namespace
} // namespace relumine::app
