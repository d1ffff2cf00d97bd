// `relumine precompute --max-memory`.
#include "tests/app/command.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

class MaxMemory : public AppTest {
protected:
    [[nodiscard]] static std::vector<std::string> run(const std::string& size,
                                                      const std::vector<std::string>& more = {}) {
        std::vector<std::string> words = {"precompute", "knot.ply",     "-o",
                                          "scene.prt",  "--max-memory", size};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
};

TEST_F(MaxMemory, RefusesBeforeTheWorkWithBothFigures) {
    succeed("generate knot -o . --vertices 20000 -q");
    fail(run("10M"), {"knot.ply: expected work within 10 MB, got a scene that takes "});
    // Every texel of 6 x 1024 x 1024.
    fail(run("200M", {"--tolerance", "0"}),
         {"knot.ply: expected work within 200 MB, got an estimate of more than ",
          " MB of memory for more than "});
    fail(run("0.06G", {"--tolerance", "0.01"}),
         {"expected work within 62 MB, got an estimate of more than "});
    for (const char* size : {"much", "-1G", "4X", "G", "0", "1e30G", "4Gigabytes"})
        misuse(run(size), "--max-memory");
}

TEST_F(MaxMemory, IsAskedBeforeAFloorIsMade) {
    succeed("generate knot -o . --vertices 1000 -q");
    const Result refused = fail(run("150M", {"--floor", "4097"}),
                                {"knot.ply: expected work within 150 MB, got a floor with which"});
    EXPECT_LT(refused.peak_bytes, SanitizerFactor * (std::uint64_t{150} << 20));
}

TEST_F(MaxMemory, TheProcessorIsNotBlamedForALimitOfTheSystem) {
    if (SanitizerFactor != 1)
        GTEST_SKIP() << "sanitizers take terabytes of addresses";
    write("mesh.obj", octahedron_obj());
    for (const std::uint64_t megabytes : {90u, 120u, 150u, 200u}) {
        const Result result = relumine("precompute mesh.obj -o scene.prt -q --refine off",
                                       {.max_address_bytes = megabytes * 1'000'000});
        EXPECT_NE(result.exit_code, -1) << result.described();
        EXPECT_EQ(result.err.find("processor"), std::string::npos) << result.described();
    }
}

TEST_F(MaxMemory, EnoughOfItChangesNothing) {
    succeed("generate knot -o . --vertices 5000 -q");
    succeed("precompute knot.ply -o plain.prt --tolerance 0.05 -q");
    const nlohmann::json report = succeed(run("110M", {"--tolerance", "0.05", "--json"})).json();
    EXPECT_EQ(read("scene.prt"), read("plain.prt"));
    const double estimate = report["memory_estimate"];
    const double peak = report["peak_bytes"];
    EXPECT_LT(estimate, 110.0 * 1024 * 1024);
    EXPECT_LT(peak, 110.0 * 1024 * 1024 * SanitizerFactor);
}

TEST_F(MaxMemory, HoldsForHighlights) {
    succeed("generate knot -o . --vertices 5000 -q");
    const auto glossy = [](std::vector<std::string> more) {
        more.insert(more.end(), {"--tolerance", "0.05", "--bounces", "0", "--view", "auto",
                                 "--material", "ggx:roughness=0.3,f0=0.04"});
        return more;
    };
    // Room for the clusters, but not for some megabytes of highlights.
    fail(run("66M", glossy({"-q"})),
         {"knot.ply: expected highlights within ", " MB of memory, got an estimate of ",
          " MB; a larger --glossy-tolerance takes less"});
    const nlohmann::json report = succeed(run("300M", glossy({"--json"}))).json();
    EXPECT_LT(report["peak_bytes"], 300.0 * 1024 * 1024 * SanitizerFactor);
    const double estimate = report["highlights_estimate"];
    EXPECT_NEAR(estimate, report["glossy"]["cells"], 0.1 * estimate);
}

} // namespace
} // namespace relumine::app
