// `relumine generate sequence` and `relumine animate`: from nothing to frames.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <limits>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

namespace fs = std::filesystem;

class Animate : public AppTest {
protected:
    Animate() {
        write("mesh.obj", octahedron_obj());
        succeed("precompute mesh.obj -o scene.prt --face-resolution 16 --refine off -q");
    }
    /// The last numbers of a .npy, as many as there are.
    [[nodiscard]] std::vector<float> numbers(const std::string& name, std::size_t count) const {
        const std::string bytes = read(name);
        std::vector<float> values(count);
        EXPECT_GE(bytes.size(), 4 * count);
        if (bytes.size() >= 4 * count)
            std::memcpy(values.data(), bytes.data() + bytes.size() - 4 * count, 4 * count);
        return values;
    }
    void lamps(int num_frames) const {
        for (int i = 0; i < num_frames; ++i)
            write("lamp." + std::to_string(i) + ".hdr",
                  lamp_hdr(10 + 20 * static_cast<std::uint32_t>(i)));
    }
};

/// Frames of --turntable are what relight draws with the camera, the environment or both turned.
TEST_F(Animate, ATurntableTurnsTheCameraTheObjectOrTheEnvironment) {
    write("lamp.hdr", lamp_hdr(10));
    const std::vector<std::string> common = {"--size", "40x30", "--background", "none", "--target",
                                             "0,0,0",  "-q"};
    const auto with = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.end(), common.begin(), common.end());
        return arguments;
    };
    for (const std::string turns : {"camera", "object", "environment"}) {
        const nlohmann::json report =
            succeed({"animate", "scene.prt", "lamp.hdr", "-o", "turn.%d.exr", "--turntable",
                     "4," + turns, "--camera", "20,30,4", "--size", "40x30", "--background", "none",
                     "--target", "0,0,0", "--json"})
                .json();
        EXPECT_EQ(report["frames"], 4);
        for (int frame = 0; frame < 4; ++frame) {
            const int degrees = turns == "object" ? -90 * frame : 90 * frame;
            const int camera = turns == "environment" ? 20 : 20 + degrees;
            const int light = turns == "camera" ? 0 : degrees;
            succeed(with({"relight", "scene.prt", "lamp.hdr", "-o", "one.exr", "--camera",
                          fmt::format("{},30,4", camera), "--rotate", fmt::format("{}", light)}));
            const auto expected = exr_channels(folder() / "one.exr");
            const auto seen = exr_channels(folder() / fmt::format("turn.{}.exr", frame));
            double difference = 0.0, sum = 0.0;
            for (std::size_t i = 0; i < expected.at("R").size(); ++i) {
                difference += std::abs(seen.at("R")[i] - expected.at("R")[i]);
                sum += expected.at("R")[i];
            }
            EXPECT_GT(sum, 0.0);
            EXPECT_LT(difference, 1e-3 * sum) << turns << " " << frame;
        }
    }
    EXPECT_NE(read("turn.0.exr"), read("turn.1.exr"));
    lamps(2);
    misuse(with({"animate", "scene.prt", "lamp.%d.hdr", "-o", "bad.%d.exr", "--turntable", "4"}),
           "--turntable");
    for (const std::string wrong : {"4,moon", "4,", ",object", "x", "100001"})
        misuse(with({"animate", "scene.prt", "lamp.hdr", "-o", "bad.%d.exr", "--turntable", wrong}),
               "--turntable");
}

/// The example of docs/animate.md: each frame is what relight draws from the camera of the path.
TEST_F(Animate, ACameraGoesAlongItsPath) {
    write("lamp.hdr", lamp_hdr(10));
    write("walk.json", R"({
    "version": 1,
    "frames": [
        {"frame": 0, "eye": [0, 1, 4], "target": [0, 0, 0], "fov_degrees": 35},
        {"frame": 4, "eye": [3, 1, 3], "target": [0, 0, 0]},
        {"frame": 6, "eye": [3, 1, 3], "target": [0, 0.5, 0], "fov_degrees": 20}
    ]
})");
    const std::vector<std::string> command = {
        "animate",      "scene.prt", "lamp.hdr",      "-o",        "walk.%d.exr", "--size", "40x30",
        "--background", "none",      "--camera-path", "walk.json", "--resume",    "--json"};
    EXPECT_EQ(succeed(command).json()["frames"], 7);
    const std::vector<std::array<std::string, 4>> keys = {{"0", "0,1,4", "0,0,0", "35"},
                                                          {"4", "3,1,3", "0,0,0", "35"},
                                                          {"6", "3,1,3", "0,0.5,0", "20"}};
    for (const auto& [frame, eye, target, fov] : keys) {
        succeed({"relight", "scene.prt", "lamp.hdr", "-o", "one.exr", "--size", "40x30",
                 "--background", "none", "--eye", eye, "--target", target, "--fov", fov, "-q"});
        const auto expected = exr_channels(folder() / "one.exr");
        const auto seen = exr_channels(folder() / ("walk." + frame + ".exr"));
        double difference = 0.0, sum = 0.0;
        for (std::size_t i = 0; i < expected.at("R").size(); ++i) {
            difference += std::abs(seen.at("R")[i] - expected.at("R")[i]);
            sum += expected.at("R")[i];
        }
        EXPECT_GT(sum, 0.0);
        EXPECT_LT(difference, 1e-3 * sum) << frame;
    }
    EXPECT_NE(read("walk.1.exr"), read("walk.2.exr"));
    // The record knows the path.
    EXPECT_EQ(succeed(command).json()["frames_kept"], 7);
    write("walk.json", R"({"version": 1, "frames": [
        {"frame": 0, "eye": [0, 1, 5], "target": [0, 0, 0]},
        {"frame": 6, "eye": [3, 1, 3], "target": [0, 0, 0]}]})");
    EXPECT_EQ(succeed(command).json()["frames_kept"], 0);
}

TEST_F(Animate, HighlightsFollowACameraPath) {
    write("lamp.hdr", lamp_hdr(10));
    write("walk.json", R"({"version": 1, "frames": [
        {"frame": 0, "eye": [0, 1, 4], "target": [0, 0, 0], "fov_degrees": 35},
        {"frame": 2, "eye": [3, 1, 3], "target": [0, 0, 0]}]})");
    succeed("precompute mesh.obj -o shiny.prt --face-resolution 16 -q --refine off --material "
            "ggx:roughness=0.4,albedo=0.3,f0=0.5");
    succeed("animate shiny.prt lamp.hdr -o walk.%d.exr --size 24x18 --background none "
            "--camera-path walk.json -q");
    const auto picture = [&](const std::string& eye, const std::vector<std::string>& more) {
        std::vector<std::string> command = {"relight", "shiny.prt", "lamp.hdr", "-o",
                                            "one.exr", "--size",    "24x18",    "--background",
                                            "none",    "--eye",     eye,        "--target",
                                            "0,0,0",   "--fov",     "35",       "-q"};
        command.insert(command.end(), more.begin(), more.end());
        succeed(command);
        return exr_channels(folder() / "one.exr");
    };
    const auto difference = [](const auto& a, const auto& b) {
        double result = 0.0, sum = 0.0;
        for (std::size_t i = 0; i < a.at("R").size(); ++i) {
            result += std::abs(a.at("R")[i] - b.at("R")[i]);
            sum += a.at("R")[i];
        }
        return result / sum;
    };
    for (const auto& [frame, eye] :
         {std::pair<std::string, std::string>{"0", "0,1,4"}, {"2", "3,1,3"}}) {
        const auto seen = exr_channels(folder() / ("walk." + frame + ".exr"));
        EXPECT_LT(difference(picture(eye, {}), seen), 1e-3) << frame;
        EXPECT_GT(difference(picture(eye, {"--material", "f0=0"}), seen), 0.05) << frame;
    }
}

TEST_F(Animate, ACameraPathThatCannotBeIsToldInOneLine) {
    write("lamp.hdr", lamp_hdr(10));
    write("path.json", R"({"version": 1, "frames": [
        {"frame": 0, "eye": [0, 0, 4], "target": [0, 0, 0]},
        {"frame": 2, "eye": [0, 0, -4], "target": [0, 0, 0]}]})");
    write("one.json", R"({"version": 1, "frames": [
        {"frame": 0, "eye": [0, 0, 4], "target": [0, 0, 0]}]})");
    const auto with = [](const std::string& path, const std::vector<std::string>& more) {
        std::vector<std::string> all = {"animate",       "scene.prt", "lamp.hdr",
                                        "--camera-path", path,        "-q"};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    };
    const std::vector<std::string> pictures = {"-o", "bad.%d.png"};
    fail(with("path.json", pictures), {"path.json: expected eye and target apart", "frame 1"});
    fail(with("one.json", pictures), {"one.json:1: expected at least 2 key frames, got 1"});
    fail(with("none.json", pictures), {"none.json: cannot read"});
    misuse(with("path.json", {"-o", "bad.%d.npy"}), "--camera-path: expected --output with .png");
    for (const std::vector<std::string>& other : {std::vector<std::string>{"--turntable", "4"},
                                                  {"--eye", "1,2,3"},
                                                  {"--target", "0,0,1"}}) {
        std::vector<std::string> both = pictures;
        both.insert(both.end(), other.begin(), other.end());
        misuse(with("path.json", both), "got both");
    }
}

TEST_F(Animate, EveryFrameIsWhatRelightMakesOfIt) {
    lamps(4);
    const nlohmann::json report =
        succeed("animate scene.prt lamp.%d.hdr -o lit.###.npy --vertices all.npy --json").json();
    EXPECT_EQ(report["frames"], 4);
    EXPECT_EQ(report["frames_lit"], 4);
    const std::vector<float> all = numbers("all.npy", std::size_t{4} * 18);
    for (std::size_t i = 0; i < 4; ++i) {
        succeed({"relight", "scene.prt", "lamp." + std::to_string(i) + ".hdr", "-o", "one.npy"});
        const std::vector<float> expected = numbers("one.npy", 18);
        const std::vector<float> frame = numbers("lit.00" + std::to_string(i) + ".npy", 18);
        for (std::size_t k = 0; k < 18; ++k) {
            EXPECT_NEAR(frame[k], expected[k], 1e-5f * (1.0f + expected[k])) << i;
            EXPECT_EQ(frame[k], all[18 * i + k]);
        }
    }
    EXPECT_NE(read("all.npy").find("'shape': (4, 6, 3)"), std::string::npos);
}

TEST_F(Animate, PicturesAreThoseOfRelight) {
    succeed("generate sequence switch -o seq --frames 4 --face-resolution 16 -q");
    const double exposure =
        succeed("animate scene.prt seq/switch.%04d.exr -o lit.%04d.png --size 40x30 --json")
            .json()["exposure"];
    // Full relightings are bit by bit the same: the first frame, and the one where the light goes
    // on. All frames have one exposure.
    for (const char* frame : {"0000", "0001"}) {
        succeed({"relight", "scene.prt", std::string("seq/switch.") + frame + ".exr", "-o",
                 "one.png", "--size", "40x30", "--exposure", std::to_string(exposure)});
        EXPECT_TRUE(read("one.png") == read(std::string("lit.") + frame + ".png"));
    }
    EXPECT_TRUE(read("lit.0002.png") == read("lit.0003.png"));
    EXPECT_FALSE(read("lit.0001.png") == read("lit.0002.png"));
}

TEST_F(Animate, TheSameForAnyNumberOfThreads) {
    succeed("generate sequence tunnel -o seq --frames 6 --face-resolution 16 -q");
    for (const char* method : {"prt", "importance"}) {
        succeed({"animate", "scene.prt", "seq/*.exr", "--vertices", "a.npy", "--threads", "1",
                 "--method", method});
        succeed({"animate", "scene.prt", "seq/*.exr", "--vertices", "b.npy", "--threads", "2",
                 "--method", method});
        EXPECT_TRUE(read("a.npy") == read("b.npy")) << method;
    }
}

TEST_F(Animate, EverySequenceIsMadeAndRead) {
    write("probe.hdr", lamp_hdr(20));
    for (const char* kind : {"sun", "switch", "clouds", "tunnel"})
        succeed({"generate", "sequence", kind, "-o", kind, "--frames", "3", "--face-resolution",
                 "8", "-q"});
    succeed("generate sequence turn probe.hdr -o turn --frames 3 -q");
    for (const char* kind : {"sun", "switch", "clouds", "tunnel", "turn"}) {
        const std::string name(kind);
        EXPECT_EQ(std::distance(fs::directory_iterator(folder() / name), {}), 3);
        succeed({"info", fmt::format("{0}/{0}.0002.exr", name)});
        const nlohmann::json report =
            succeed({"animate", "scene.prt", fmt::format("{0}/{0}.####.exr", name), "--vertices",
                     "v.npy", "--json"})
                .json();
        EXPECT_EQ(report["frames"], 3);
    }
    misuse("generate sequence -o x", "KIND");
    misuse("generate sequence flood -o x", "flood");
    misuse("generate sequence turn -o x", "ENV: expected an environment");
    misuse("generate sequence sun probe.hdr -o x", "ENV: expected none");
    misuse("generate sequence sun -o x --frames 0", "--frames");
    misuse("generate blob sun -o x", "KIND");
    misuse("generate sequence sun -o x --face-resolution 0", "--face-resolution");
}

TEST_F(Animate, ClustersLightLikeTheFramesAndFlickerIsMeasured) {
    succeed("generate sequence sun -o seq --frames 6 --face-resolution 32 -q");
    succeed("animate scene.prt seq/sun.%04d.exr --vertices prt.npy -q");
    const auto same =
        succeed("animate scene.prt seq/sun.%04d.exr --vertices again.npy --measure prt.npy --json")
            .json();
    EXPECT_EQ(same["mean_inconsistency"], 0.0);
    EXPECT_EQ(same["mean_relative_l2"], 0.0);
    const auto clusters =
        succeed("animate scene.prt seq/sun.%04d.exr --method clusters --lights 100 "
                "--vertices clusters.npy --measure prt.npy --json")
            .json();
    EXPECT_EQ(clusters["samples"], 6 * 1024);
    EXPECT_EQ(clusters["light_clusters"], 100);
    EXPECT_GT(clusters["mean_live_lights"].get<double>(), 1.0);
    EXPECT_LT(clusters["mean_relative_l2"].get<double>(), 0.15);
    EXPECT_GT(clusters["mean_inconsistency"].get<double>(), 0.0);
    ASSERT_EQ(clusters["inconsistency"].size(), 5u);
    // A frame of pictures made later from all the same inputs is kept; other clusters are other
    // pictures.
    const std::vector<std::string> pictures = {
        "animate", "scene.prt", "seq/sun.%04d.exr", "--method", "clusters", "--lights",
        "20",      "-o",        "a.%04d.npy",       "--resume", "--json"};
    EXPECT_EQ(succeed(pictures).json()["frames_kept"], 0);
    EXPECT_EQ(succeed(pictures).json()["frames_kept"], 6);
    std::vector<std::string> others = pictures;
    others[6] = "30";
    EXPECT_EQ(succeed(others).json()["frames_kept"], 0);
    misuse("animate scene.prt seq/sun.%04d.exr -o b.%04d.npy --measure prt.npy",
           "expected --vertices");
    fail("animate scene.prt seq/sun.%04d.exr --vertices b.npy --measure none.npy",
         {"none.npy: cannot read"});
}

TEST_F(Animate, MissingAndDifferentFramesAreToldBeforeWorkStarts) {
    lamps(4);
    fs::remove(folder() / "lamp.2.hdr");
    fail("animate scene.prt lamp.%d.hdr -o lit.%d.npy",
         {"lamp.%d.hdr", "expected frames 0 to 3 without a gap", "none for 2"});
    fail("animate scene.prt lamp.%d.hdr --frames 3-5 -o lit.%d.npy", {"none for 4-5"});
    write("lamp.2.hdr", white_hdr()); // 64 x 32
    fail("animate scene.prt lamp.%d.hdr -o lit.%d.npy",
         {"lamp.2.hdr", "expected 128x64", "got 64x32"});
    fail("animate scene.prt none.%d.hdr -o lit.%d.npy", {"none.%d.hdr", "no file"});
    misuse("animate scene.prt lamp.%d.hdr --frames 3-1 -o lit.%d.npy",
           "relumine: --frames: expected FIRST-LAST or FIRST-LASTxSTEP, got '3-1'");
    succeed("animate scene.prt lamp.%d.hdr --frames 0-1 -o lit.%d.npy -q");
}

TEST_F(Animate, ABadFrameEndsItAndFinishedFramesStay) {
    lamps(4);
    const std::string whole = read("lamp.2.hdr");
    const auto run_until_2 = [&](const std::vector<std::string>& parts) {
        for (const char* name : {"lit.0.npy", "lit.1.npy", "lit.all.npy.done"})
            fs::remove(folder() / name);
        const Result result =
            relumine("animate scene.prt lamp.%d.hdr -o lit.%d.npy --vertices v.npy -q");
        EXPECT_EQ(result.exit_code, 1) << result.described();
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.described();
        for (const std::string& part : parts)
            EXPECT_NE(result.err.find(part), std::string::npos) << result.described();
        EXPECT_EQ(numbers("lit.0.npy", 18).size(), 18u);
        EXPECT_TRUE(fs::exists(folder() / "lit.1.npy"));
        EXPECT_FALSE(fs::exists(folder() / "lit.2.npy"));
        EXPECT_FALSE(fs::exists(folder() / "v.npy"));
        for (const auto& entry : fs::directory_iterator(folder()))
            EXPECT_NE(entry.path().filename().string().front(), '.') << entry.path();
    };
    write("lamp.2.hdr", whole.substr(0, whole.size() - 100));
    run_until_2({"lamp.2.hdr", "expected"});
    // By its content it is an OpenEXR file, whatever its name.
    write("lamp.2.hdr", exr_file(128, 64, [](std::uint32_t x, std::uint32_t) {
              return Rgb{x == 5 ? std::numeric_limits<float>::quiet_NaN() : 1.0f, 1, 1};
          }));
    run_until_2({"lamp.2.hdr", "NaN", "--fix-env"});

    // Mended, it goes on from there.
    write("lamp.2.hdr", whole);
    const nlohmann::json report =
        succeed("animate scene.prt lamp.%d.hdr -o lit.%d.npy --resume --json").json();
    EXPECT_EQ(report["frames_kept"], 2);
    EXPECT_EQ(report["frames_lit"], 2);
}

TEST_F(Animate, ResumeMakesOnlyWhatIsNotThereAnyMore) {
    lamps(4);
    const std::vector<std::string> command = {"animate",    "scene.prt", "lamp.%d.hdr", "-o",
                                              "lit.%d.npy", "--resume",  "--json"};
    const auto kept = [&](const std::vector<std::string>& more = {}) {
        std::vector<std::string> all = command;
        all.insert(all.end(), more.begin(), more.end());
        return succeed(all).json()["frames_kept"].get<int>();
    };
    EXPECT_EQ(kept(), 0);
    EXPECT_EQ(kept(), 4);
    write("lit.1.npy", "cut sho"); // an output that is not what was written
    fs::remove(folder() / "lit.2.npy");
    EXPECT_EQ(kept(), 2);
    write("lamp.3.hdr", lamp_hdr(99)); // an input that changed
    EXPECT_EQ(kept(), 3);
    EXPECT_EQ(kept({"--rotate", "90"}), 0); // other settings
    EXPECT_EQ(kept({"--rotate", "90"}), 4);
    EXPECT_EQ(kept(), 0);
    write("lit.all.npy.done", "nonsense\n");
    EXPECT_EQ(kept(), 0);
    // One file of all frames needs all of them lit.
    EXPECT_EQ(
        succeed("animate scene.prt lamp.%d.hdr -o lit.%d.npy --resume --vertices v.npy --json")
            .json()["frames_lit"],
        4);
}

TEST_F(Animate, NumbersAreTheSameWhenPicturesGoOn) {
    lamps(3);
    const std::vector<std::string> command = {"animate",    "scene.prt",  "lamp.%d.hdr", "-o",
                                              "lit.%d.png", "--vertices", "v.npy",       "--size",
                                              "40x30",      "-q"};
    succeed(command);
    const std::string numbers = read("v.npy"), picture = read("lit.1.png");
    fs::remove(folder() / "lit.1.png");
    std::vector<std::string> again = command;
    again.emplace_back("--resume");
    succeed(again);
    EXPECT_EQ(read("v.npy"), numbers);
    EXPECT_EQ(read("lit.1.png"), picture);
}

TEST_F(Animate, AnInterruptLeavesWholeFramesToGoOnFrom) {
    succeed("generate sequence tunnel -o seq --frames 100 --face-resolution 32 -q");
    const std::vector<std::string> command = {"animate", "scene.prt",    "seq/tunnel.%04d.exr",
                                              "-o",      "lit.%04d.png", "--size",
                                              "500x400", "-q",           "--resume"};
    Process process(folder(), command);
    while (process.is_running() && !fs::exists(folder() / "lit.0002.png"))
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    process.send(SIGINT);
    const Result result = process.wait();
    EXPECT_EQ(result.exit_code, 1) << result.described();
    EXPECT_TRUE(result.err.starts_with("relumine: cancelled; ")) << result.described();
    EXPECT_NE(result.err.find("of 100 frames are written, --resume goes on"), std::string::npos)
        << result.err;
    std::size_t num_frames = 0;
    for (const auto& entry : fs::directory_iterator(folder())) {
        EXPECT_NE(entry.path().filename().string().front(), '.') << entry.path();
        num_frames += static_cast<std::size_t>(entry.path().extension() == ".png");
    }
    EXPECT_GE(num_frames, 3u);
    EXPECT_LT(num_frames, 100u);
    std::vector<std::string> again = command;
    again.insert(again.end(), {"--json", "--frames", "0-20"});
    EXPECT_EQ(succeed(again).json()["frames_kept"].get<std::size_t>(),
              std::min<std::size_t>(num_frames, 21));
}

TEST_F(Animate, AMovieNeedsFfmpeg) {
    lamps(2);
    const std::string path = std::getenv("PATH");
    const std::vector<std::string> command = {"animate",    "scene.prt", "lamp.%d.hdr", "-o",
                                              "lit.%d.png", "--mp4",     "out.mp4",     "--size",
                                              "8x6",        "-q"};
    ::setenv("PATH", folder().c_str(), 1);
    fail(command, {"out.mp4: expected ffmpeg on the PATH"});

    // A stand-in that keeps its input: what it gets are the pictures, one after the other.
    write("ffmpeg", "#!/bin/sh\nfor last; do :; done\nexec /bin/cat > \"$last\"\n");
    fs::permissions(folder() / "ffmpeg", fs::perms::owner_all);
    succeed(command);
    EXPECT_TRUE(read("out.mp4") == read("lit.0.png") + read("lit.1.png"));

    write("out.mp4", "the old one");
    write("ffmpeg", "#!/bin/sh\necho first >&2\necho no such codec >&2\nexit 1\n");
    const Result result = relumine(command);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(result.err, "relumine: out.mp4: ffmpeg failed: no such codec\n");
    EXPECT_EQ(read("out.mp4"), "the old one");
    for (const auto& entry : fs::directory_iterator(folder()))
        EXPECT_NE(entry.path().filename().string().front(), '.') << entry.path();
    ::setenv("PATH", path.c_str(), 1);
    misuse("animate scene.prt lamp.%d.hdr -o lit.%d.npy --mp4 out.mp4",
           "--mp4: expected --output with .png frames");
}

TEST_F(Animate, OutputsThatCannotBe) {
    lamps(2);
    misuse("animate scene.prt lamp.%d.hdr", "-o");
    misuse("animate scene.prt lamp.%d.hdr -o lit.%d.png --lights -1", "--lights");
    misuse("animate scene.prt lamp.%d.hdr -o lit.%d.png --method magic", "--method");
    misuse("animate scene.prt lamp.%d.hdr -o lit.png",
           "--output: expected a place for the frame's number");
    misuse("animate scene.prt lamp.%d.hdr -o lit.%d.jpg",
           "--output: expected a name that ends in .png");
    fail("animate scene.prt lamp.%d.hdr -o no/lit.%d.png", {"no/lit.%d.png", "cannot write"});
    misuse("animate scene.prt lamp.%d.hdr --vertices v.txt",
           "--vertices: expected a name that ends in .npy, got 'v.txt'");
    write("in.0.exr", exr_file(4, 2, [](std::uint32_t, std::uint32_t) { return Rgb{1, 1, 1}; }));
    fail("animate scene.prt in.%d.exr -o in.%d.exr", {"in.0.exr", "other than the input"});
    fail("animate missing.prt lamp.%d.hdr -o lit.%d.png", {"missing.prt"});
}

} // namespace
} // namespace relumine::app
