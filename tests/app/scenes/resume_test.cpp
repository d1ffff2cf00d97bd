// `relumine precompute` stopped at any moment and taken up again.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "tests/app/command.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

namespace fs = std::filesystem;

class Resume : public AppTest {
protected:
    /// Options of a run that leaves a checkpoint whenever it can.
    [[nodiscard]] static std::vector<std::string> run(const std::vector<std::string>& more = {}) {
        std::vector<std::string> words = {
            "precompute",           "knot.ply", "--refine", "off", "-o", "scene.prt", "-q",
            "--checkpoint-seconds", "0.001"};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
    /// Runs the command and kills it after `seconds`. Whether it was still running.
    [[nodiscard]] bool killed_after(const std::vector<std::string>& arguments,
                                    double seconds) const {
        Process process(folder(), arguments);
        std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
        const bool was_running = process.is_running();
        process.send(SIGKILL);
        static_cast<void>(process.wait());
        return was_running;
    }
    void expect_no_leftovers(const std::vector<std::string>& expected) const {
        std::vector<std::string> names;
        for (const fs::directory_entry& entry : fs::directory_iterator(folder()))
            names.push_back(entry.path().filename().string());
        std::sort(names.begin(), names.end());
        EXPECT_EQ(names, expected);
    }
};

TEST_F(Resume, KilledAtTwentyMomentsTheFileIsTheSame) {
    succeed("generate knot -o . --vertices 1500 -q");
    const std::vector<std::string> scene = {"--tolerance", "0.03"};
    const double seconds = succeed(run(scene)).seconds;
    const std::string expected = read("scene.prt");
    std::mt19937 random(1);
    std::vector<std::string> again = scene;
    again.emplace_back("--resume");
    int num_killed = 0;
    int num_taken_up = 0;
    for (int i = 0; i < 20; ++i) {
        fs::remove(folder() / "scene.prt");
        // The first dozen runs are killed once, the rest again and again until one of them is
        // through.
        std::uniform_real_distribution<double> moment(0.0, i < 12 ? seconds : 0.7 * seconds);
        bool killed = killed_after(run(scene), moment(random));
        num_killed += killed ? 1 : 0;
        for (int again_killed = 0; i >= 12 && killed && again_killed < 3; ++again_killed) {
            killed = killed_after(run(again), moment(random));
            num_killed += killed ? 1 : 0;
        }
        num_taken_up += fs::exists(folder() / "scene.prt.checkpoint" / "clusters.state") ? 1 : 0;
        succeed(run(again));
        ASSERT_EQ(read("scene.prt"), expected) << "kill " << i;
        expect_no_leftovers({"knot.ply", "scene.prt"});
    }
    RecordProperty("killed", num_killed);
    RecordProperty("taken up", num_taken_up);
}

TEST_F(Resume, KilledWithACheckpointItIsTakenUp) {
    succeed("generate knot -o . --vertices 6000 -q");
    const std::vector<std::string> scene = {"--tolerance", "0.02"};
    succeed(run(scene));
    const std::string expected = read("scene.prt");
    const fs::path state = folder() / "scene.prt.checkpoint" / "clusters.state";
    // A run that is through before the kill is tried again.
    for (int i = 0; i < 20 && !fs::exists(state); ++i) {
        fs::remove(folder() / "scene.prt");
        Process process(folder(), run(scene));
        while (!fs::exists(state) && process.is_running())
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        process.send(SIGKILL);
        static_cast<void>(process.wait());
    }
    ASSERT_TRUE(fs::exists(state));
    std::vector<std::string> again = {"precompute", "knot.ply",  "--refine", "off",
                                      "-o",         "scene.prt", "-v",       "--resume"};
    again.insert(again.end(), scene.begin(), scene.end());
    EXPECT_NE(succeed(again).out.find("going on from scene.prt.checkpoint"), std::string::npos);
    EXPECT_EQ(read("scene.prt"), expected);
}

TEST_F(Resume, WithoutACheckpointItSaysThatItBeginsAnew) {
    write("mesh.obj", octahedron_obj());
    std::vector<std::string> words = {"precompute", "mesh.obj", "-o",          "scene.prt",
                                      "--refine",   "off",      "--tolerance", "1"};
    EXPECT_EQ(succeed(words).out.find("anew"), std::string::npos);
    words.emplace_back("--resume");
    EXPECT_EQ(succeed(words).out.find(
                  "--resume: scene.prt.checkpoint is not there, the work begins anew\n"),
              0u);
}

TEST_F(Resume, HighlightsAreTakenUpToo) {
    succeed("generate knot -o . --vertices 1200 -q");
    const std::vector<std::string> scene = {"--tolerance", "0.05",       "--view",
                                            "auto",        "--material", "ggx:roughness=0.4"};
    const double seconds = succeed(run(scene)).seconds;
    const std::string expected = read("scene.prt");
    std::vector<std::string> again = scene;
    again.emplace_back("--resume");
    for (const double part : {0.3, 0.6, 0.75, 0.9}) {
        fs::remove(folder() / "scene.prt");
        static_cast<void>(killed_after(run(scene), part * seconds));
        succeed(run(again));
        ASSERT_EQ(read("scene.prt"), expected) << part;
    }
    expect_no_leftovers({"knot.ply", "scene.prt"});
}

TEST_F(Resume, StoppedByASignalItSaysHowToGoOn) {
    succeed("generate knot -o . --vertices 20000 -q");
    const std::vector<std::string> endless = run({"--tolerance", "0.0005"});
    Process process(folder(), endless);
    const fs::path state = folder() / "scene.prt.checkpoint" / "clusters.state";
    while (!fs::exists(state) && process.is_running())
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    process.send(SIGTERM);
    const Result result = process.wait();
    EXPECT_EQ(result.exit_code, 1) << result.described();
    EXPECT_EQ(
        result.err,
        "relumine: cancelled; the same command with --resume goes on from scene.prt.checkpoint\n");
    EXPECT_FALSE(fs::exists(folder() / "scene.prt"));
    // Other work than that is refused, and says why.
    fail(run({"--tolerance", "0.1", "--resume"}),
         {"scene.prt.checkpoint: expected a checkpoint of this run "
          "(tolerance 0.1), got another's (tolerance 0.0005)"});
    fail(run({"--tolerance", "0.0005", "--floor", "--resume"}),
         {"scene.prt.checkpoint: expected a checkpoint of this run"});
    fs::resize_file(state, 100);
    EXPECT_EQ(relumine(run({"--tolerance", "0.0005", "--resume"})).err,
              "relumine: scene.prt.checkpoint/clusters.state: expected a checkpoint, got damaged "
              "data; without "
              "--resume the work begins anew\n");
    // Without --resume it is done from the start, and the old checkpoint goes with the new.
    succeed(run({"--tolerance", "0.3"}));
    expect_no_leftovers({"knot.ply", "scene.prt"});
    // Nothing to take up: as without.
    const std::string expected = read("scene.prt");
    succeed(run({"--tolerance", "0.3", "--resume"}));
    EXPECT_EQ(read("scene.prt"), expected);
}

TEST_F(Resume, AFullDiskAtTheEndLosesNothing) {
    succeed("generate knot -o . --vertices 6000 -q");
    const std::vector<std::string> scene = {"--tolerance", "0.02"};
    succeed(run(scene));
    const std::string expected = read("scene.prt");
    fs::remove(folder() / "scene.prt");
    // The scene is larger than any of the checkpoint's files here.
    const Result result = relumine(run(scene), {.max_file_bytes = expected.size() - 1});
    EXPECT_EQ(result.exit_code, 1) << result.described();
    const std::string needed =
        "scene.prt: cannot write: File too large: " + std::to_string(expected.size()) +
        " bytes needed, " + std::to_string(expected.size() - 1) + " allowed";
    EXPECT_NE(result.err.find(needed), std::string::npos) << result.described();
    EXPECT_FALSE(fs::exists(folder() / "scene.prt"));
    succeed(run({"--tolerance", "0.02", "--resume"}));
    EXPECT_EQ(read("scene.prt"), expected);
    // Where not even a checkpoint can be written, the work goes on all the same.
    const Result tiny = relumine(run(scene), {.max_file_bytes = 100});
    EXPECT_EQ(tiny.exit_code, 1) << tiny.described();
    EXPECT_EQ(read("scene.prt"), expected);
}

TEST_F(Resume, TwoRunsOfOneSceneBothEndAndOneWinsWhole) {
    succeed("generate knot -o . --vertices 3000 -q");
    succeed(run({"--tolerance", "0.03"}));
    const std::string first = read("scene.prt");
    succeed(run({"--tolerance", "0.04"}));
    const std::string second = read("scene.prt");
    fs::remove(folder() / "scene.prt");
    for (int i = 0; i < 3; ++i) {
        Process a(folder(), run({"--tolerance", "0.03"}));
        Process b(folder(), run({"--tolerance", "0.04"}));
        const Result of_a = a.wait();
        const Result of_b = b.wait();
        EXPECT_EQ(of_a.exit_code, 0) << of_a.described();
        EXPECT_EQ(of_b.exit_code, 0) << of_b.described();
        const std::string got = read("scene.prt");
        EXPECT_TRUE(got == first || got == second);
        expect_no_leftovers({"knot.ply", "scene.prt"});
    }
}

TEST_F(Resume, AnOutputThatIsALinkIsWrittenThrough) {
    write("mesh.obj", octahedron_obj());
    fs::create_directory(folder() / "far");
    fs::create_symlink("far/scene.prt", folder() / "scene.prt");
    succeed("precompute mesh.obj -o scene.prt --face-resolution 16 -q --refine off");
    EXPECT_TRUE(fs::is_symlink(folder() / "scene.prt"));
    EXPECT_TRUE(fs::is_regular_file(folder() / "far" / "scene.prt"));
    succeed("info scene.prt");
}

} // namespace
} // namespace relumine::app
