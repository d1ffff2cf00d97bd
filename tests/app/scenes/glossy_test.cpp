// Scenes with highlights, from the mesh to the picture.
#include <algorithm>
#include <string>

#include <gmock/gmock.h>

#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

class Glossy : public AppTest {
protected:
    Glossy() {
        write("mesh.obj", octahedron_obj());
        write("white.hdr", white_hdr());
    }
    nlohmann::json make(const std::string& scene, const std::vector<std::string>& more) const {
        std::vector<std::string> arguments = {
            "precompute", "mesh.obj",          "--refine", "off",     "-o",
            scene,        "--face-resolution", "64",       "--floor", "9",
            "--json",     "--tolerance",       "0.03"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return succeed(arguments).json();
    }
};

TEST_F(Glossy, HighlightsOnVerticesAreVerified) {
    const nlohmann::json made =
        make("s.prt", {"--material", "ggx:roughness=0.4,albedo=0.3,f0=0.5", "--view", "auto"});
    EXPECT_GT(made["glossy"]["cells"], 100);
    EXPECT_LT(succeed("verify s.prt white.hdr --samples 200 --json").json()["relative_l2"], 0.02);
    succeed("relight s.prt white.hdr -o lit.png --size 32x24");
    EXPECT_EQ(png_size(read("lit.png")), (Size{32, 24}));
    const auto warnings = [&](const std::string& camera) {
        return succeed({"relight", "s.prt", "white.hdr", "-o", "lit.png", "--size", "8x6", camera,
                        "--json"})
            .json()["warnings"]
            .dump();
    };
    EXPECT_THAT(warnings("--camera=100,10"), testing::HasSubstr("stands elsewhere"));
    EXPECT_THAT(warnings("--camera=24,20"), testing::Not(testing::HasSubstr("elsewhere")));
    succeed("relight s.prt white.hdr -o lit.npy");
    make("d.prt", {"--material", "lambert:albedo=0.3"});
    succeed("relight d.prt white.hdr -o dull.npy");
    auto shiny = npy_values(read("lit.npy"));
    auto dull = npy_values(read("dull.npy"));
    ASSERT_EQ(shiny.size(), 6u + 81u);
    // The floor is not what the mesh is.
    for (std::size_t i = 6; i < shiny.size(); ++i)
        EXPECT_EQ(shiny[i], dull[i]) << i;
    EXPECT_GT(shiny[6][0], 0.9f);
    shiny.resize(6);
    dull.resize(6);
    // Under white light albedo (1 - F0) and most of F0 come back, 0.15 + 0.5, where the eye sees
    // the surface.
    const auto brightest = [](const auto& values) {
        return (*std::max_element(values.begin(), values.end(),
                                  [](const auto& a, const auto& b) { return a[0] < b[0]; }))[0];
    };
    EXPECT_GT(brightest(shiny), 1.5f * brightest(dull));
}

TEST_F(Glossy, PixelsTexelsEditsAndFramesTakeThem) {
    make("s.prt", {"--material", "blinn:exponent=20,kd=0.3,ks=0.5", "--view", "auto", "--receivers",
                   "pixels:24x16"});
    succeed("relight s.prt white.hdr -o lit.exr");
    EXPECT_EQ(exr_size(read("lit.exr")), (Size{24, 16}));
    EXPECT_LT(succeed("verify s.prt white.hdr --samples 200 --json").json()["relative_l2"], 0.03);
    write("layers.json",
          R"({"version": 1, "layers": [{"name": "lamp", "type": "disc", "direction": [0, 1, 0.2],
        "radius_degrees": 10, "effect": "emit", "radiance": [5, 4, 3]}]})");
    succeed("edit s.prt white.hdr layers.json -o edited.png");
    write("f.0001.hdr", white_hdr());
    write("f.0002.hdr", white_hdr());
    succeed("animate s.prt f.%04d.hdr -o out.%04d.png -q");
    EXPECT_EQ(png_size(read("out.0002.png")), (Size{24, 16}));
}

TEST_F(Glossy, AnAlbedoScalesTheLight) {
    make("plain.prt", {});
    make("half.prt", {"--material", "lambert:albedo=0.5"});
    succeed("relight plain.prt white.hdr -o plain.npy");
    succeed("relight half.prt white.hdr -o half.npy");
    const auto plain = npy_values(read("plain.npy"));
    const auto half = npy_values(read("half.npy"));
    for (std::size_t i = 0; i < plain.size(); ++i)
        EXPECT_NEAR(half[i][1], (i < 6 ? 0.5f : 1.0f) * plain[i][1], 1e-6f);
}

TEST_F(Glossy, TheFloorShinesOnlyWhereItIsAskedTo) {
    const std::string shape = "ggx:roughness=0.5,albedo=0.2,f0=0.5";
    const auto cells = [&](const std::vector<std::string>& materials) {
        std::vector<std::string> more = {"--view", "auto"};
        for (const std::string& material : materials)
            more.insert(more.end(), {"--material", material});
        return make("s.prt", more)["glossy"]["cells"].get<int>();
    };
    const int mesh_alone = cells({shape});
    const int both = cells({shape, "floor=" + shape});
    EXPECT_GT(both, 2 * mesh_alone);
    // Its own albedo is not replaced by the grey of pictures.
    succeed("relight s.prt white.hdr -o a.exr --floor-albedo 0.1");
    succeed("relight s.prt white.hdr -o b.exr --floor-albedo 0.9");
    EXPECT_TRUE(read("a.exr") == read("b.exr"));
}

TEST_F(Glossy, ColoursMayChangeAfterwards) {
    const std::string shape = "ggx:roughness=0.4,";
    make("one.prt", {"--material", shape + "albedo=0.2,f0=0.9", "--view", "auto"});
    make("two.prt", {"--material", shape + "albedo=0.7,0.5,0.3,f0=0.1", "--view", "auto"});
    succeed("relight one.prt white.hdr -o one.npy --material albedo=0.7,0.5,0.3,f0=0.1");
    succeed("relight two.prt white.hdr -o two.npy");
    EXPECT_EQ(npy_values(read("one.npy")), npy_values(read("two.npy")));
    make("plain.prt", {});
    misuse("relight plain.prt white.hdr -o n.npy --material albedo=0.5",
           "--material: expected a scene with materials");
    for (const char* wrong : {"albedo=-1", "albedo", "0.5", "kd=0.5", "albedo=0.1,0.2", "f0="})
        misuse(fmt::format("relight one.prt white.hdr -o n.npy --material {}", wrong).c_str(),
               "--material: expected ");
}

TEST_F(Glossy, RoughnessMayChangeWhereHighlightsFollowTheEye) {
    const std::string colors = "albedo=0.2,f0=0.9";
    make("one.prt", {"--material", "ggx:roughness=0.3," + colors});
    make("two.prt", {"--material", "ggx:roughness=0.7," + colors});
    const auto picture = [&](const std::string& scene, const std::vector<std::string>& more) {
        std::vector<std::string> arguments = {"relight", scene,    "white.hdr", "-o",
                                              "lit.exr", "--size", "16x12"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        succeed(arguments);
        return read("lit.exr");
    };
    EXPECT_TRUE(picture("one.prt", {"--material", "roughness=0.7"}) == picture("two.prt", {}));
    EXPECT_EQ(succeed("verify one.prt white.hdr --eye 3,2,5 --material roughness=0.7 --json")
                  .json()["relative_l2"],
              succeed("verify two.prt white.hdr --eye 3,2,5 --json").json()["relative_l2"]);
    make("fixed.prt", {"--material", "ggx:roughness=0.4," + colors, "--view", "auto"});
    misuse("relight fixed.prt white.hdr -o n.npy --material roughness=0.5",
           "--material: fixed.prt: expected highlights that follow the eye");
    make("matt.prt", {"--material", "lambert:albedo=0.3"});
    misuse("relight matt.prt white.hdr -o n.npy --material roughness=0.5",
           "--material: matt.prt: expected surfaces with GGX highlights");
    misuse("relight one.prt white.hdr -o n.npy --material roughness=2",
           "--material: expected a roughness from 0 to 1");
}

TEST_F(Glossy, EyesWithoutSenseAreToldOf) {
    make("live.prt", {"--material", "ggx:roughness=0.05,albedo=0.2,f0=0.9"});
    make("matt.prt", {});
    const auto verified = [&](const std::string& eye) {
        return succeed({"verify", "live.prt", "white.hdr", "--eye", eye, "--json"})
            .json()["warnings"]
            .dump();
    };
    EXPECT_THAT(verified("0,0.01,0"), testing::HasSubstr("is inside of the mesh"));
    const std::string outside = verified("3,2,5");
    EXPECT_THAT(outside, testing::Not(testing::HasSubstr("inside")));
    EXPECT_THAT(outside, testing::HasSubstr("smoother than roughness 0.11"));
    const std::string drawn =
        succeed("relight live.prt white.hdr -o in.png --size 8x6 --eye 0,0.01,0 --json")
            .json()["warnings"]
            .dump();
    EXPECT_THAT(drawn, testing::HasSubstr("is inside of the mesh"));
    const Result refused = fail("verify matt.prt white.hdr --eye 3,2,5");
    EXPECT_THAT(refused.err, testing::HasSubstr("expected vertices with glossy materials"));
}

TEST_F(Glossy, LimitsAreSaid) {
    const std::string sharp = "ggx:roughness=0.05,f0=0.5";
    const Result warned = succeed({"precompute", "mesh.obj", "-o", "s.prt", "--face-resolution",
                                   "16", "--material", sharp, "--view", "auto", "--refine", "off"});
    EXPECT_NE(warned.err.find("smoother than roughness"), std::string::npos) << warned.described();
    const Result no_view = succeed({"precompute", "mesh.obj", "-o", "d.prt", "--face-resolution",
                                    "16", "--material", sharp, "--refine", "off"});
    EXPECT_NE(no_view.err.find("--view"), std::string::npos) << no_view.described();
    misuse("precompute mesh.obj -o n.prt --material glass", "--material");
    misuse("precompute mesh.obj -o n.prt --glossy-tolerance 0", "--glossy-tolerance");
}

} // namespace
} // namespace relumine::app
