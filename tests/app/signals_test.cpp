// Ctrl-C and SIGTERM: a soon end, one line, nothing left behind. And a real full disk.
#include <chrono>
#include <csignal>
#include <thread>

#include <sys/mount.h>

#include "tests/app/command.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

namespace fs = std::filesystem;

class Signals : public AppTest {
protected:
    /// Nearly every texel of 6 x 1024 x 1024: hours.
    const std::vector<std::string> Endless = {"precompute",  "knot.ply", "-o", "scene.prt",
                                              "--tolerance", "0.0005",   "-q"};

    /// Sends the signals `delay` after the program takes them, with a millisecond between them, and
    /// expects the end soon.
    void interrupt(const std::vector<std::string>& arguments, const std::vector<int>& signals,
                   std::chrono::milliseconds delay) const {
        const std::vector<std::string> before = files();
        Process process(folder(), arguments);
        process.wait_until_it_takes(SIGTERM);
        std::this_thread::sleep_for(delay);
        ASSERT_TRUE(process.is_running()) << "done before it could be stopped";
        const double before_signal = process.processor_seconds();
        for (const int signal : signals) {
            process.send(signal);
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        const Result result = process.wait();
        EXPECT_LT(result.processor_seconds - before_signal, 4.0 * SanitizerFactor)
            << result.described();
        EXPECT_EQ(result.exit_code, 1) << result.described();
        EXPECT_EQ(result.out, "");
        EXPECT_EQ(result.err, "relumine: cancelled; nothing was written\n");
        EXPECT_EQ(files(), before);
    }
};

TEST_F(Signals, PrecomputeStopsAtOnce) {
    succeed("generate knot -o . --vertices 20000 -q");
    write("scene.prt", "the old one");
    interrupt(Endless, {SIGINT}, std::chrono::milliseconds(300));
    interrupt(Endless, {SIGTERM}, std::chrono::milliseconds(700));
    interrupt(Endless, {SIGHUP}, std::chrono::milliseconds(300));
    // As `timeout` sends it: to the process, then to its group.
    interrupt(Endless, {SIGTERM, SIGCONT, SIGTERM}, std::chrono::milliseconds(300));
    // While it starts and loads.
    interrupt(Endless, {SIGINT}, std::chrono::milliseconds(0));
    interrupt(Endless, {SIGINT}, std::chrono::milliseconds(10));
}

TEST_F(Signals, AClosedTerminalIsNothingToNohup) {
    succeed("generate knot -o . --vertices 20000 -q");
    Process process(folder(), Endless, {.ignored_signal = SIGHUP});
    process.wait_until_it_takes(SIGTERM);
    process.send(SIGHUP);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    EXPECT_TRUE(process.is_running());
    process.send(SIGTERM);
    EXPECT_EQ(process.wait().err, "relumine: cancelled; nothing was written\n");
}

TEST_F(Signals, WorkOfLibrariesThatDoNotPollStopsAtOnce) {
    write("white.hdr", white_hdr());
    interrupt({"env", "convert", "white.hdr", "--rotate", "33", "--size", "16384x8192", "-o",
               "large.exr", "-q"},
              {SIGINT}, std::chrono::milliseconds(1000));
    succeed("generate blob -o . --vertices 2000 -q");
    succeed("precompute blob.ply -o scene.prt --tolerance 0.1 --refine off --bounces 0 -q");
    interrupt(
        {"relight", "scene.prt", "white.hdr", "--size", "12000x12000", "-o", "large.png", "-q"},
        {SIGTERM}, std::chrono::milliseconds(1000));
}

TEST_F(Signals, VerifyStopsAtOnce) {
    succeed("generate blob -o . --vertices 20000 -q");
    write("white.hdr", white_hdr());
    succeed("precompute blob.ply -o scene.prt --tolerance 0.05 --bounces 0 -q");
    interrupt(
        {"verify", "scene.prt", "white.hdr", "--samples", "0", "--face-resolution", "512", "-q"},
        {SIGINT}, std::chrono::milliseconds(1500));
}

TEST_F(Signals, ProgressIsPlainLinesWithTheTimeLeft) {
    succeed("generate knot -o . --vertices 15000 -q");
    const Result result =
        succeed("precompute knot.ply -o scene.prt --tolerance 0.0135 --bounces 0 --json");
    ASSERT_FALSE(result.json().empty());
    EXPECT_EQ(result.err.find('\r'), std::string::npos) << result.described();
    // Five seconds after it began, work tells of its next tenth.
    if (result.json()["seconds_clustering"].get<double>() > 10.0) {
        EXPECT_NE(result.err.find("left\n"), std::string::npos) << result.described();
    }
}

/// A file system of 64 KiB, where the system lets us have one.
class FullDisk : public AppTest {
protected:
    void SetUp() override {
        const fs::path disk = folder() / "disk";
        fs::create_directory(disk);
        mounted_ = ::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=64k") == 0;
        if (!mounted_)
            GTEST_SKIP() << "a small file system cannot be mounted here";
    }
    void TearDown() override {
        if (mounted_)
            ::umount((folder() / "disk").c_str());
    }

private:
    bool mounted_ = false;
};

TEST_F(FullDisk, LeavesTheOldFile) {
    write("mesh.obj", octahedron_obj());
    write("white.hdr", white_hdr());
    succeed("precompute mesh.obj -o disk/scene.prt --refine off --face-resolution 16 -q");
    succeed("relight disk/scene.prt white.hdr -o disk/lit.npy");
    const std::vector<std::string> no_space = {"cannot write", "No space left"};
    fail("generate blob -o disk --vertices 3000", no_space);

    succeed("generate blob -o . --vertices 7000 -q");
    succeed("precompute blob.ply -o scene.prt --refine off --bounces 0 --face-resolution 16");
    for (const char* name : {"disk/lit.npy", "disk/lit.ply", "disk/lit.glb"})
        fail({"relight", "scene.prt", "white.hdr", "-o", name}, no_space);
    fail("precompute blob.ply -o disk/scene.prt --refine off --bounces 0 --face-resolution 16 -q",
         no_space);
    succeed("info disk/scene.prt");
}

} // namespace
} // namespace relumine::app
