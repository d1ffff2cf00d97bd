// `relumine move`: things move in a scene's file, and what is refused.
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/vec3.hpp>
#include <gmock/gmock.h>

#include "prt/scene/scene_file.h"
#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

class Move : public AppTest {
protected:
    Move() {
        write("mesh.obj", octahedron_obj());
        write("white.hdr", white_hdr());
    }
    void precompute(const std::vector<std::string>& options) {
        std::vector<std::string> arguments = {
            "precompute", "mesh.obj",          "-o", "scene.prt", "--floor", "17", "--tolerance",
            "0.05",       "--face-resolution", "64", "--refine",  "off",     "-q"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        succeed(arguments);
    }
    std::vector<Rgb> light_of(const std::string& scene) {
        succeed({"relight", scene, "white.hdr", "-o", "light.npy", "-q"});
        return npy_values(read("light.npy"));
    }
};

TEST_F(Move, MovesAndComesBack) {
    precompute({"--movable", "--bounces", "0.05"});
    const std::vector<Rgb> before = light_of("scene.prt");
    const nlohmann::json report =
        succeed("move scene.prt mesh=0.5,0,0 mesh=0.25,0,0 -o moved.prt --json").json();
    ASSERT_EQ(report["moves"].size(), 2u);
    EXPECT_EQ(report["moves"][0]["name"], "mesh");
    EXPECT_GT(report["moves"][0]["pairs_changed"], 0);
    EXPECT_EQ(report["bytes"], std::filesystem::file_size(folder() / "moved.prt"));
    succeed("info moved.prt --check -q");
    EXPECT_NE(light_of("moved.prt"), before);
    EXPECT_TRUE(prt::load_scene(folder() / "moved.prt").bounces.has_value());
    // Steps that floats hold exactly lead back to the same scene.
    succeed("move moved.prt mesh=-0.75,0,0 -o moved.prt -q");
    const prt::Scene back = prt::load_scene(folder() / "moved.prt"),
                     first = prt::load_scene(folder() / "scene.prt");
    EXPECT_EQ(back.mesh.positions, first.mesh.positions);
    EXPECT_EQ(back.transfer.counts.counts, first.transfer.counts.counts);
    EXPECT_EQ(light_of("moved.prt"), before);
}

TEST_F(Move, TakesAwayAndBringsBack) {
    precompute({"--movable", "--bounces", "0.05"});
    const std::vector<Rgb> before = light_of("scene.prt");
    EXPECT_THAT(succeed("move scene.prt mesh=away -o away.prt").out,
                testing::HasSubstr("mesh: taken away"));
    succeed("info away.prt --check -q");
    EXPECT_NE(light_of("away.prt"), before);
    fail("move away.prt mesh=1,0,0 -o back.prt",
         {"away.prt: expected a group that is there, got mesh, which was taken away"});
    succeed("move away.prt mesh=back -o back.prt -q");
    EXPECT_EQ(light_of("back.prt"), before);
    fail("move back.prt mesh=back -o back.prt", {"back.prt: expected", "which is there"});
}

TEST_F(Move, TakesThePoseOfAFile) {
    precompute({"--movable", "--bounces", "0.05"});
    const std::vector<Rgb> before = light_of("scene.prt");
    // As tall again. A file without groups is the group as a whole.
    std::string tall;
    std::istringstream lines(octahedron_obj());
    for (std::string line; std::getline(lines, line);) {
        glm::dvec3 at(0.0);
        if (std::sscanf(line.c_str(), "v %lf %lf %lf", &at.x, &at.y, &at.z) == 3)
            line = fmt::format("v {} {} {}", at.x, 2.0 * at.y, at.z);
        tall += line + "\n";
    }
    write("tall.obj", tall);
    const nlohmann::json report = succeed("move scene.prt mesh=tall.obj -o tall.prt --json").json();
    EXPECT_GT(report["moves"][0]["receivers"], 0);
    EXPECT_GT(report["moves"][0]["pairs_changed"], 0);
    succeed("info tall.prt --check -q");
    EXPECT_NE(light_of("tall.prt"), before);
    EXPECT_THAT(succeed("move tall.prt mesh=mesh.obj -o back.prt").out,
                testing::HasSubstr("mesh: posed as in mesh.obj"));
    EXPECT_EQ(light_of("back.prt"), before);

    write("few.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    fail("move scene.prt mesh=few.obj -o no.prt", {"scene.prt: expected the", "vertices of mesh"});
    write("other.obj", "g other\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    fail("move scene.prt mesh=other.obj -o no.prt",
         {"other.obj: expected one of 1 groups, got 'mesh'"});
    fail("move scene.prt mash=tall.obj -o no.prt", {"scene.prt", "did you mean mesh?"});
    fail("move scene.prt mesh=absent.obj -o no.prt", {"absent.obj: cannot read"});
    fail("move scene.prt mesh=tall.obj -o no.prt --pose 0@1", {"tall.obj"});
    misuse("move scene.prt mesh=1,0,0 -o no.prt --pose 0@1", "--pose");
    EXPECT_FALSE(std::filesystem::exists(folder() / "no.prt"));
}

TEST_F(Move, VerifyTellsWhatAPrecomputeWouldChoose) {
    precompute({"--movable"});
    const nlohmann::json check = succeed("verify scene.prt white.hdr --samples 5 --json").json();
    const auto own = check["clusters"].get<double>();
    EXPECT_EQ(check["clusters"], prt::load_scene(folder() / "scene.prt").transfer.num_clusters());
    EXPECT_NEAR(check["fresh_clusters"].get<double>(), own, 0.1 * own);
    // Its shadow is wide and soft now.
    succeed("move scene.prt mesh=0,3,0 -o high.prt -q");
    const nlohmann::json high = succeed("verify high.prt white.hdr --samples 5 --json").json();
    EXPECT_EQ(high["clusters"], check["clusters"]);
    EXPECT_GT(high["fresh_clusters"].get<double>(), 1.2 * own);
    precompute({});
    EXPECT_FALSE(
        succeed("verify scene.prt white.hdr --samples 5 --json").json().contains("clusters"));
}

TEST_F(Move, WhoDoesNotAskGetsTheSameFile) {
    precompute({});
    const prt::Scene plain = prt::load_scene(folder() / "scene.prt");
    EXPECT_TRUE(plain.mesh.groups.empty());
    precompute({"--movable"});
    prt::Scene movable = prt::load_scene(folder() / "scene.prt");
    EXPECT_THAT(movable.mesh.groups, testing::ElementsAre("mesh", "floor"));
    EXPECT_EQ(plain.transfer.counts.counts, movable.transfer.counts.counts);
    movable.settings.is_movable = false;
    movable.bounces->rays = {};
    prt::save_scene(folder() / "again.prt", movable);
    precompute({});
    EXPECT_EQ(read("again.prt"), read("scene.prt"));
}

TEST_F(Move, Refuses) {
    precompute({"--movable"});
    fail("move scene.prt mush=1,0,0 -o moved.prt",
         {"scene.prt: expected one of 2 groups, got 'mush'; did you mean mesh?"});
    fail("move scene.prt floor=1,0,0 -o moved.prt", {"scene.prt: expected", "added floor"});
    fail("move scene.prt mesh=1e30,0,0 -o moved.prt", {"scene.prt: expected coordinates"});
    fail("move absent.prt mesh=1,0,0 -o moved.prt", {"absent.prt"});
    misuse("move scene.prt mesh=1,0 -o moved.prt", "STEP");
    misuse("move scene.prt -o moved.prt", "STEP");
    misuse("move scene.prt mesh=1,0,0 -o moved.ply", "--output");
    EXPECT_FALSE(std::filesystem::exists(folder() / "moved.prt"));
    precompute({});
    fail("move scene.prt mesh=1,0,0 -o moved.prt", {"scene.prt: expected", "--movable"});
    precompute({"--movable", "--receivers", "pixels:24x16", "--view", "auto"});
    fail("move scene.prt mesh=1,0,0 -o moved.prt", {"scene.prt: expected", "pixels"});
    fail("precompute mesh.obj -o other.prt --movable -q",
         {"mesh.obj: expected a mesh with groups"});
}

} // namespace
} // namespace relumine::app
