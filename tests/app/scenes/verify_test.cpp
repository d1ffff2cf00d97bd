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
        succeed("precompute mesh.obj -o scene.prt --face-resolution 32 --refine off -q");
    }
};

TEST_F(Verify, AllKeysOfTheReport) {
    const nlohmann::json report = succeed("verify scene.prt white.hdr --json").json();
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
    std::vector<std::string> verify = {"verify", "scene.prt", "white.hdr"};
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

TEST_F(Verify, SamplesAreAsManyAsWereAskedFor) {
    const auto some = succeed("verify scene.prt white.hdr --samples 1 --json").json();
    EXPECT_EQ(some["samples"], 1);
    EXPECT_EQ(some["surface"]["points"], 1);
    EXPECT_EQ(succeed("verify scene.prt white.hdr --samples 0 --json").json()["samples"], 6);
}

TEST_F(Verify, ItIsTheSceneFileThatIsTested) {
    // A hundredfold tolerance must show.
    succeed("generate colonnade -o . --vertices 1000 -q");
    write("lamp.hdr", lamp_hdr(40));
    const auto error = [&](const std::string& tolerance) {
        succeed({"precompute", "colonnade.ply", "-o", "c.prt", "--tolerance", tolerance,
                 "--face-resolution", "64", "--refine", "off"});
        return succeed("verify c.prt lamp.hdr --samples 200 --clusters-only --json")
            .json()["relative_l2"]
            .get<double>();
    };
    EXPECT_GT(error("1"), 3.0 * error("0.01"));
}

TEST_F(Verify, BadOptionsAreRefused) {
    for (const char* samples : {"-5", "nan", "1.5", "all"})
        misuse({"verify", "scene.prt", "white.hdr", "--samples", samples}, "--samples");
    fail("verify missing.prt white.hdr", {"missing.prt"});
    fail("verify scene.prt missing.hdr", {"missing.hdr"});
    fail("verify scene.prt mesh.obj", {"mesh.obj"});
    misuse("verify scene.prt white.hdr --rotate nan", "--rotate");
}

} // namespace
} // namespace relumine::app
