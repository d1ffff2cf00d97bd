// Pictures that are no environment, or not quite, through `info`, `relight` and `verify`.
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

constexpr float NaN = std::numeric_limits<float>::quiet_NaN();
constexpr float Infinity = std::numeric_limits<float>::infinity();

class EnvironmentFiles : public AppTest {
protected:
    EnvironmentFiles() {
        write("mesh.obj", octahedron_obj());
        succeed("precompute mesh.obj -o scene.prt --face-resolution 16 --refine off -q");
    }
    void refused(const std::string& name, const std::string& content,
                 const std::vector<std::string>& parts = {}) const {
        write(name, content);
        std::vector<std::string> all = parts;
        all.push_back(name);
        for (const std::vector<std::string>& arguments :
             {std::vector<std::string>{"info", name},
              {"relight", "scene.prt", name, "-o", "new.npy"},
              {"verify", "scene.prt", name}}) {
            const Result result = fail(arguments, all);
            EXPECT_LT(result.processor_seconds, AtOnce) << name;
            EXPECT_LT(result.peak_bytes, 200'000'000u * SanitizerFactor) << name;
        }
    }
};

Rgb grey(std::uint32_t, std::uint32_t) {
    return {0.5f, 0.5f, 0.5f};
}

TEST_F(EnvironmentFiles, AspectRatiosThatNoLayoutHas) {
    for (const auto& [width, height] :
         {std::pair{30u, 30u}, {16u, 32u}, {100u, 40u}, {1u, 1u}, {32u, 15u}}) {
        refused("env.hdr", hdr_file(width, height, grey),
                {"2:1", fmt::format("{}x{}", width, height)});
        refused("env.exr", exr_file(width, height, grey),
                {"2:1", fmt::format("{}x{}", width, height)});
    }
    write("square.hdr", hdr_file(32, 32, grey));
    fail("relight scene.prt square.hdr -o new.npy --layout cube", {"square.hdr", "1:6"});
    fail("relight scene.prt square.hdr -o new.npy --layout cross", {"square.hdr", "3:4"});
}

TEST_F(EnvironmentFiles, LayoutsByTheirAspectRatio) {
    for (const auto& [width, height, layout] :
         {std::tuple{32u, 16u, "lat-long"}, {8u, 48u, "cube"}, {24u, 32u, "cross"}})
        for (const char* name : {"env.hdr", "env.exr"}) {
            write(name, std::string(name) == "env.hdr" ? hdr_file(width, height, grey)
                                                       : exr_file(width, height, grey));
            const nlohmann::json info = succeed({"info", name, "--json"}).json();
            EXPECT_EQ(info["kind"], "environment");
            EXPECT_NE(info["layout"].get<std::string>().find(layout), std::string::npos) << info;
            EXPECT_EQ(info["width"], width);
            EXPECT_NEAR(info["mean_luminance"].get<double>(), 0.5, 1e-3);
            succeed({"relight", "scene.prt", name, "-o", "lit.npy"});
            for (const auto& value : npy_values(read("lit.npy")))
                EXPECT_NEAR(value[1], 0.5f, 2e-3f) << layout << ' ' << name;
        }
}

TEST_F(EnvironmentFiles, BadPixelsAreCountedRefusedAndFixedOnRequest) {
    write("bad.exr", exr_file(32, 16, [](std::uint32_t x, std::uint32_t y) {
              if (y == 8 && x < 3)
                  return Rgb{1.0f, NaN, 1.0f};
              if (y == 9 && x < 2)
                  return Rgb{Infinity, 1.0f, 1.0f};
              if (y == 10 && x < 4)
                  return Rgb{1.0f, 1.0f, -2.0f};
              return Rgb{1.0f, 1.0f, 1.0f};
          }));
    const nlohmann::json info = succeed("info bad.exr --json").json();
    EXPECT_EQ(info["num_nan"], 3);
    EXPECT_EQ(info["num_infinite"], 2);
    EXPECT_EQ(info["num_negative"], 4);
    const Result told = succeed("info bad.exr");
    EXPECT_NE(told.out.find("3 NaN, 2 infinite, 4 negative"), std::string::npos)
        << told.described();

    fail("relight scene.prt bad.exr -o new.npy",
         {"bad.exr", "--fix-env", "5 NaN/Inf", "4 negative", "(0, 8)"});
    fail("verify scene.prt bad.exr", {"bad.exr", "--fix-env"});
    fail("edit scene.prt bad.exr -o new.npy --disc 0,1,0,10", {"bad.exr", "--fix-env"});

    const Result fixed = succeed("relight scene.prt bad.exr -o new.npy --fix-env");
    EXPECT_NE(fixed.out.find("replaced 9 bad pixels"), std::string::npos) << fixed.described();
    for (const auto& value : npy_values(read("new.npy")))
        for (const float channel : value) {
            EXPECT_TRUE(std::isfinite(channel));
            EXPECT_GE(channel, 0.0f);
            EXPECT_LE(channel, 1.01f);
        }
    EXPECT_FALSE(succeed("relight scene.prt bad.exr -o new.npy --fix-env --json").json().empty());
}

TEST_F(EnvironmentFiles, NothingButBadPixels) {
    for (const float bad : {NaN, Infinity, -Infinity, -1.0f}) {
        write("bad.exr",
              exr_file(32, 16, [bad](std::uint32_t, std::uint32_t) { return Rgb{bad, bad, bad}; }));
        fail("relight scene.prt bad.exr -o new.npy", {"bad.exr", "--fix-env", "512"});
        succeed("info bad.exr");
        const nlohmann::json info = succeed("info bad.exr --json").json();
        EXPECT_EQ(info["num_nan"].get<int>() + info["num_infinite"].get<int>() +
                      info["num_negative"].get<int>(),
                  512);
        // There is nothing left to light with, or black; either way no NaN.
        const Result fixed = relumine("relight scene.prt bad.exr -o black.npy --fix-env");
        if (fixed.exit_code == 0) {
            for (const auto& value : npy_values(read("black.npy")))
                EXPECT_EQ(value[0], 0.0f) << bad;
        } else {
            EXPECT_EQ(fixed.exit_code, 1) << fixed.described();
        }
    }
}

TEST_F(EnvironmentFiles, BlackIsAnEnvironment) {
    write("black.hdr",
          hdr_file(32, 16, [](std::uint32_t, std::uint32_t) { return Rgb{0.0f, 0.0f, 0.0f}; }));
    succeed("info black.hdr");
    succeed("info black.hdr --json");
    succeed("relight scene.prt black.hdr -o black.npy");
    for (const auto& value : npy_values(read("black.npy")))
        EXPECT_EQ(value[0], 0.0f);
    EXPECT_EQ(succeed("verify scene.prt black.hdr --json").json()["max_abs"], 0.0);
    succeed("edit scene.prt black.hdr -o black.npy --disc 0,1,0,10 --gain 5");
    succeed("relight scene.prt black.hdr -o black.png --size 8x8");
}

TEST_F(EnvironmentFiles, HugeDeclaredSizes) {
    for (const char* size :
         {"-Y 40000 +X 80000", "-Y 1000000000 +X 2000000000", "-Y 99999999999 +X 199999999998",
          "-Y 16384 +X 32768", "-Y 0 +X 0", "-Y -16 +X -32"})
        refused("env.hdr",
                std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n") + size + "\n\1\2\3\4");
    // The declared window of an intact small picture, changed.
    const std::string small = exr_file(32, 16, grey);
    const std::string tag("box2i\0\x10\0\0\0\0\0\0\0\0\0\0\0", 18);
    for (const std::string& corner : {std::string("\xff\xff\0\0\xff\x7f\0\0", 8),
                                      std::string("\xff\xff\xff\x7f\xff\xff\xff\x3f", 8),
                                      std::string("\xff\xff\xff\xff\xff\xff\xff\xff", 8)}) {
        std::string huge = small;
        const std::size_t window = huge.find(tag);
        ASSERT_NE(window, std::string::npos);
        huge.replace(window + tag.size(), 8, corner);
        refused("env.exr", huge);
    }
}

TEST_F(EnvironmentFiles, OtherFiles) {
    refused("env.exr", "\x89PNG\r\n\x1a\n");
    refused("env.hdr", octahedron_obj());
    refused("env.hdr", read("scene.prt"));
    fail("info missing.exr", {"missing.exr", "cannot read"});
}

} // namespace
} // namespace relumine::app
