// `--bounces` of precompute, relight and verify.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

class Bounces : public AppTest {
protected:
    Bounces() {
        succeed("generate colonnade -o . --vertices 2000 -q");
        write("white.hdr", white_hdr());
    }

    void precompute(const std::string& output, const std::vector<std::string>& more = {}) {
        std::vector<std::string> arguments = {
            "precompute", "colonnade.ply", "-o",  output, "--face-resolution",
            "64",         "--refine",      "off", "-q"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        succeed(arguments);
    }

    [[nodiscard]] std::vector<std::array<float, 3>> relit(const std::string& scene,
                                                          std::vector<std::string> more) {
        more.insert(more.begin(), {"relight", scene, "white.hdr", "-o", "out.npy", "-q"});
        succeed(more);
        return npy_values(read("out.npy"));
    }
};

double mean(const std::vector<std::array<float, 3>>& values) {
    double sum = 0.0;
    for (const auto& value : values)
        sum += static_cast<double>(value[1]);
    return sum / static_cast<double>(values.size());
}

TEST_F(Bounces, AddLightAndAreAPartOfTheirOwn) {
    precompute("scene.prt", {"--bounces"});
    precompute("direct.prt", {"--bounces", "0"});
    const auto direct = relit("direct.prt", {});
    EXPECT_EQ(relit("scene.prt", {"--bounces", "0"}), direct) << "direct light stays as it is";
    const auto all = relit("scene.prt", {});
    const auto only = relit("scene.prt", {"--bounces", "only"});
    const auto once = relit("scene.prt", {"--bounces", "1"});
    ASSERT_EQ(all.size(), direct.size());
    for (std::size_t i = 0; i < all.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            ASSERT_NEAR(all[i][c], direct[i][c] + only[i][c], 1e-5f);
    EXPECT_GT(mean(only), 0.02 * mean(direct));
    EXPECT_GT(mean(all), mean(once));
    EXPECT_GT(mean(once) - mean(direct), 0.5 * mean(only));
    EXPECT_EQ(all, relit("scene.prt", {"--bounces", "all"}));
}

TEST_F(Bounces, AreThereWhereVerticesSeeOtherSurfaces) {
    precompute("scene.prt");
    const auto num_bounces = [&](const std::string& scene) {
        return succeed({"relight", scene, "white.hdr", "-o", "lit.npy", "--json"})
            .json()["bounces"]
            .get<int>();
    };
    EXPECT_GT(num_bounces("scene.prt"), 0);
    // Nothing is before the faces of a box.
    write("box.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                     "f 4 3 2 1\nf 6 7 8 5\nf 2 6 5 1\nf 8 7 3 4\nf 5 8 4 1\nf 3 7 6 2\n");
    succeed("precompute box.obj -o box.prt --face-resolution 16 --refine off -q");
    EXPECT_EQ(num_bounces("box.prt"), 0);
}

TEST_F(Bounces, AgreeWithAPathTracer) {
    precompute("scene.prt", {"--bounces", "0.01", "--tolerance", "0.01"});
    const auto verify = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments = {"verify", "scene.prt", "white.hdr", "--samples",
                                              "40",     "--albedo",  "0.8",       "--paths",
                                              "1000",   "--json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return succeed(arguments).json();
    };
    const nlohmann::json with = verify({"--bounces", "all"}), without = verify({});
    EXPECT_GT(with["bounces"], 2);
    EXPECT_GT(with["noise"], 0.0);
    EXPECT_LT(with["noise"], 0.02);
    // The mesh is coarse, so light between its vertices is, too.
    EXPECT_LT(with["relative_l2"], 0.05);
    EXPECT_EQ(without["bounces"], 0);
    EXPECT_EQ(without["noise"], 0.0);
    EXPECT_GT(with["mean_radiance"], 1.03 * without["mean_radiance"].get<double>());
}

double largest_difference(const std::vector<std::array<float, 3>>& a,
                          const std::vector<std::array<float, 3>>& b) {
    double largest = a.size() == b.size() ? 0.0 : 1e30;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            largest = std::max(largest, std::abs(static_cast<double>(a[i][c] - b[i][c])));
    return largest;
}

TEST_F(Bounces, GoThroughEditsFramesAndLightLists) {
    precompute("scene.prt", {"--bounces", "0.05"});
    const auto plain = relit("scene.prt", {});
    // An edit of the whole sphere by 2.
    succeed("edit scene.prt white.hdr --disc 0,1,0,180 --gain 2 -o edited.npy -q");
    const auto edited = npy_values(read("edited.npy"));
    EXPECT_NEAR(mean(edited), 2.0 * mean(plain), 2e-3 * mean(edited));
    succeed("edit scene.prt white.hdr --disc 0,1,0,180 --gain 2 -o direct.npy --bounces 0 -q");
    EXPECT_LT(mean(npy_values(read("direct.npy"))), 0.99 * mean(edited));
    // What the whole sphere lights is everything.
    const nlohmann::json share =
        succeed("edit scene.prt white.hdr --disc 0,1,0,10 --lit-by 0,1,0,180 -o part.png --json")
            .json();
    EXPECT_NEAR(share["lit_by_share"], 1.0, 2e-3);
    EXPECT_GT(share["bounces"], 0);
    succeed("edit scene.prt white.hdr --disc 0,1,0,10 --who 0,0,0 -o who.exr -q");

    // Frames.
    write("frame.0000.hdr", white_hdr());
    write("frame.0001.hdr", white_hdr());
    succeed("animate scene.prt frame.%04d.hdr -o lit.###.npy -q");
    EXPECT_EQ(npy_values(read("lit.000.npy")), plain);
    EXPECT_EQ(npy_values(read("lit.001.npy")), plain);

    // A list and an environment bounce together.
    write("sun.json", R"({"version": 1, "lights": [)"
                      R"({"direction": [0, 1, 0], "irradiance": [3, 2, 1]}]})");
    succeed("relight scene.prt --lights sun.json -o list.npy -q");
    const auto list = npy_values(read("list.npy"));
    auto sum = plain;
    for (std::size_t i = 0; i < sum.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            sum[i][c] += list[i][c];
    EXPECT_LT(largest_difference(relit("scene.prt", {"--lights", "sun.json"}), sum), 5e-3);
}

TEST_F(Bounces, WrongUseIsOneLine) {
    precompute("direct.prt", {"--bounces", "0"});
    fail("relight direct.prt white.hdr -o x.png --bounces all",
         {"direct.prt: expected a scene made with `relumine precompute --bounces`"});
    fail("relight direct.prt white.hdr -o x.png --bounces only",
         {"direct.prt: expected a scene made with `relumine precompute --bounces`"});
    fail("edit direct.prt white.hdr --disc 0,1,0,10 -o x.png --bounces 2",
         {"direct.prt: expected a scene made with `relumine precompute --bounces`"});
    write("frame.0000.hdr", white_hdr());
    fail("animate direct.prt frame.%04d.hdr --vertices x.npy --bounces 2",
         {"direct.prt: expected a scene made with `relumine precompute --bounces`"});
    misuse("relight direct.prt -o x.png", "expected ENV, --lights or both");
    misuse("relight direct.prt white.hdr -o x.png --bounces many",
           "--bounces: expected a number of bounces, 'only' or 'all', got 'many'");
    misuse("precompute colonnade.ply -o x.prt --bounces 2", "--bounces: expected 0 to 1, got '2'");
    misuse("precompute --bounces colonnade.ply -o x.prt", "the mesh goes first");
    misuse("verify direct.prt white.hdr --albedo nan", "--albedo");
    misuse("relight direct.prt white.hdr -o x.png --albedo nan", "--albedo");
    // Points are no surfaces.
    write("points.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                        "property float y\nproperty float z\nend_header\n0 0 0\n");
    fail("precompute points.ply -o x.prt --bounces", {"points.ply: "});
    EXPECT_FALSE(std::filesystem::exists(folder() / "x.prt"));
}

/// A cube whose faces look inwards.
std::string closed_room() {
    return "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
           "f 1 2 3 4\nf 5 8 7 6\nf 1 5 6 2\nf 4 3 7 8\nf 1 4 8 5\nf 2 6 7 3\n";
}

TEST_F(Bounces, LightThatWouldGrowForEverIsRefusedWithTheLargestSafeAlbedo) {
    write("room.obj", closed_room());
    succeed("precompute room.obj -o room.prt --bounces --face-resolution 16 -q");
    fail("relight room.prt white.hdr -o x.png --albedo 1.1",
         {"room.prt: expected an albedo up to 0.99", ", beyond which bounces grow for ever, got "});
    EXPECT_FALSE(std::filesystem::exists(folder() / "x.png"));
    // A white room loses a little.
    succeed("relight room.prt white.hdr -o x.png --albedo 1 -q");
}

TEST_F(Bounces, PixelsAndTexelsGetThemFromTheVertices) {
    write("lamp.hdr", lamp_hdr(40));
    const std::string mesh = read("colonnade.ply");
    const std::vector<std::string> pixels = {"--receivers", "pixels:48x32", "--view",
                                             "auto",        "--bounces",    "0.02"};
    precompute("pixels.prt", pixels);
    const nlohmann::json info = succeed("info pixels.prt --json").json();
    EXPECT_LE(info["receivers"], 48 * 32);
    const auto all = relit("pixels.prt", {});
    ASSERT_EQ(all.size(), info["receivers"].get<std::size_t>()) << "vertices are not shown";
    const auto direct = relit("pixels.prt", {"--bounces", "0"});
    EXPECT_GT(mean(all), 1.02 * mean(direct));
    // Edits and frames end where a new environment does.
    succeed("edit pixels.prt white.hdr --disc 0,1,0,180 --gain 2 -o edited.npy -q");
    EXPECT_NEAR(mean(npy_values(read("edited.npy"))), 2.0 * mean(all), 4e-3 * mean(all));
    write("frame.0000.hdr", white_hdr());
    succeed("animate pixels.prt frame.%04d.hdr -o lit.##.npy --vertices v.npy -q");
    EXPECT_EQ(npy_values(read("lit.00.npy")), all);
    succeed("relight pixels.prt white.hdr -o picture.png -q");
    succeed("relight pixels.prt white.hdr -o only.exr --bounces only -q");
    const nlohmann::json check = succeed("verify pixels.prt lamp.hdr --samples 100 --albedo 0.8 "
                                         "--paths 500 --bounces all --json")
                                     .json();
    EXPECT_GT(check["bounces"], 1);
    EXPECT_LT(check["relative_l2"], 0.05 + check["noise"].get<double>());
    EXPECT_LT(check["worst_receiver"], info["receivers"]);
}

TEST_F(Bounces, KilledAtManyMomentsTheFileIsTheSame) {
    const std::vector<std::string> run = {
        "precompute",           "colonnade.ply", "--refine",  "off",   "-o", "scene.prt",
        "--tolerance",          "0.2",           "--bounces", "0.003", "-q", "--resume",
        "--checkpoint-seconds", "0.001"};
    const double seconds = succeed(run).seconds;
    const std::string expected = read("scene.prt");
    for (const double part : {0.2, 0.5, 0.7, 0.9}) {
        std::filesystem::remove(folder() / "scene.prt");
        Process process(folder(), run);
        std::this_thread::sleep_for(std::chrono::duration<double>(part * seconds));
        process.send(SIGKILL);
        static_cast<void>(process.wait());
        succeed(run);
        ASSERT_EQ(read("scene.prt"), expected) << part;
        EXPECT_FALSE(std::filesystem::exists(folder() / "scene.prt.checkpoint"));
    }
}

TEST_F(Bounces, AreWithinTheMemory) {
    const std::vector<std::string> run = {
        "precompute", "colonnade.ply", "-o", "x.prt",    "--tolerance", "0.2",
        "--bounces",  "0.0002",        "-q", "--refine", "off",         "--max-memory"};
    const auto within = [&](const std::string& bytes) {
        std::vector<std::string> words = run;
        words.push_back(bytes);
        return words;
    };
    fail(within("60M"), {"colonnade.ply: expected bounces within ", " MB of memory, got ",
                         "; a larger error of --bounces takes less"});
    EXPECT_FALSE(std::filesystem::exists(folder() / "x.prt"));
    succeed(within("1G"));
}

} // namespace
} // namespace relumine::app
