// `relumine verify`: its figures and options.
#include <algorithm>

#include <fmt/format.h>

#include "tests/app/command.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

class Verify : public AppTest {
protected:
    Verify() {
        write("mesh.obj", octahedron_obj());
        write("white.hdr", white_hdr());
        succeed("precompute mesh.obj -o scene.prt --face-resolution 32 --no-refine -q");
    }
};

TEST_F(Verify, AllKeysOfTheReport) {
    const nlohmann::json report = succeed("verify scene.prt white.hdr --surface 20 --json").json();
    for (const char* key : {"relative_l2", "mean_abs", "max_abs", "samples"}) {
        ASSERT_TRUE(report.contains(key)) << key;
        EXPECT_TRUE(report[key].is_number()) << key;
    }
    EXPECT_EQ(report["samples"], 6) << "no more than there are";
    EXPECT_LT(report["relative_l2"], 0.01);
    EXPECT_NEAR(report["mean_radiance"].get<double>(), 1.0, 2e-3);
    EXPECT_LT(report["worst_vertex"], 6);
}

TEST_F(Verify, WhatAPictureShowsIsSaidFirst) {
    std::vector<std::string> verify = {"verify", "scene.prt", "white.hdr", "--surface", "20"};
    const auto run = succeed(verify);
    verify.emplace_back("--json");
    const nlohmann::json report = succeed(verify).json();
    const double worst = report["worst"]["relative_l2"];
    EXPECT_EQ(worst, std::max({report["relative_l2"].get<double>(),
                               report["surface"]["relative_l2"].get<double>(),
                               report["picture"]["relative_l2"].get<double>()}));
    const double shown = report["picture"]["relative_l2"];
    EXPECT_EQ(run.out.find(fmt::format(
                  "the light is off by {:.3g} % in a picture of the whole mesh", 100.0 * shown)),
              0u)
        << run.out;
    const bool is_worse = worst > std::max(0.05, 2.0 * shown);
    EXPECT_EQ(run.out.find("; elsewhere by") != std::string::npos, is_worse) << run.out;
}

TEST_F(Verify, SamplesAreChosenBySeed) {
    const auto worst = [&](const std::string& seed) {
        return succeed({"verify", "scene.prt", "white.hdr", "--samples", "1", "--surface", "0",
                        "--seed", seed, "--json"})
            .json();
    };
    EXPECT_EQ(worst("1")["samples"], 1);
    EXPECT_EQ(worst("1")["worst_vertex"], worst("1")["worst_vertex"]);
    std::vector<int> seen(6);
    for (int seed = 0; seed < 12; ++seed)
        ++seen.at(worst(std::to_string(seed))["worst_vertex"].get<std::size_t>());
    for (const int count : seen)
        EXPECT_LT(count, 12) << "another seed never chose another receiver";
    EXPECT_EQ(
        succeed("verify scene.prt white.hdr --samples 0 --surface 0 --json").json()["samples"], 6);
}

TEST_F(Verify, ItIsTheSceneFileThatIsTested) {
    // A hundredfold tolerance must show.
    succeed("generate colonnade -o . --vertices 1000 -q");
    write("lamp.hdr", lamp_hdr(40));
    const auto error = [&](const std::string& tolerance) {
        succeed({"precompute", "colonnade.ply", "-o", "c.prt", "--tolerance", tolerance,
                 "--min-depth", "1", "--face-resolution", "64", "--no-refine"});
        return succeed("verify c.prt lamp.hdr --samples 200 --surface 0 --clusters-only --json")
            .json()["relative_l2"]
            .get<double>();
    };
    EXPECT_GT(error("1"), 3.0 * error("0.01"));
}

TEST_F(Verify, BadOptionsAreRefused) {
    for (const char* samples : {"-5", "nan", "1.5", "all"})
        misuse({"verify", "scene.prt", "white.hdr", "--samples", samples}, "--samples");
    misuse("verify scene.prt white.hdr --surface 4294967296", "--surface");
    misuse("verify scene.prt white.hdr --seed -1", "--seed");
    fail("verify missing.prt white.hdr", {"missing.prt"});
    fail("verify scene.prt missing.hdr", {"missing.hdr"});
    fail("verify scene.prt mesh.obj", {"mesh.obj"});
    misuse("verify scene.prt white.hdr --rotate nan", "--rotate");
}

} // namespace
} // namespace relumine::app
