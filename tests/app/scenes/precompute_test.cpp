// `relumine precompute`: options and what it refuses.
#include <sys/stat.h>

#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

namespace fs = std::filesystem;

class Precompute : public AppTest {
protected:
    Precompute() {
        write("mesh.obj", octahedron_obj());
        write("white.hdr", white_hdr());
    }
    /// The command line for new.prt, at R = 16 unless the options say otherwise.
    [[nodiscard]] static std::vector<std::string> command(const std::vector<std::string>& options) {
        std::vector<std::string> arguments = {"precompute", "mesh.obj", "-o",
                                              "new.prt",    "--refine", "off"};
        if (options.empty() || options[0] != "--face-resolution")
            arguments.insert(arguments.end(), {"--face-resolution", "16"});
        arguments.insert(arguments.end(), options.begin(), options.end());
        return arguments;
    }
    [[nodiscard]] nlohmann::json made(std::vector<std::string> options) const {
        options.emplace_back("--json");
        return succeed(command(options)).json();
    }
};

TEST_F(Precompute, AllKeysOfTheReport) {
    const nlohmann::json report = made({});
    for (const char* key : {"vertices", "triangles", "clusters", "samples", "rays", "seconds",
                            "peak_bytes", "file_bytes"}) {
        ASSERT_TRUE(report.contains(key)) << key;
        EXPECT_TRUE(report[key].is_number()) << key;
    }
    EXPECT_EQ(report["vertices"], 6);
    EXPECT_EQ(report["triangles"], 8);
    EXPECT_EQ(report["file_bytes"], fs::file_size(folder() / "new.prt"));
}

TEST_F(Precompute, TheFloorHasTheVerticesAskedFor) {
    EXPECT_EQ(made({"--floor", "5"})["vertices"], 6 + 25);
    EXPECT_EQ(made({"--floor", "5"})["triangles"], 8 + 32);
    const nlohmann::json floor = made({"--floor", "5"})["floor"];
    EXPECT_EQ(floor["vertices"], 5);
    EXPECT_NEAR(floor["side"].get<double>(), 8.0, 1e-5);
    EXPECT_NEAR(floor["spacing_inside"].get<double>(), 1.1, 1e-5);
    EXPECT_NEAR(floor["spacing_outside"].get<double>(), 2.9, 1e-5);
    EXPECT_NE(succeed(command({"--floor", "5"}))
                  .out.find("floor: 5 x 5 vertices over 8 x 8; one "
                            "spans 1.1 under the mesh"),
              std::string::npos);
    EXPECT_EQ(succeed("info new.prt --json").json()["floor"], 5);
    // Without a number, last on the line or before another option.
    const nlohmann::json automatic = made({"--tolerance", "0.2", "--floor"});
    EXPECT_EQ(automatic["floor"]["vertices"], 25);
    EXPECT_GT(automatic["floor"]["added"], 50);
    EXPECT_EQ(automatic["vertices"], 6 + 25 * 25 + automatic["floor"]["added"].get<int>());
    EXPECT_NEAR(automatic["floor"]["side"].get<double>(), 8.0, 1e-5);
}

TEST_F(Precompute, ACoarseMeshGetsVerticesUnlessItMustNot) {
    // A wall on the ground.
    write("wall.obj", "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 4 3 2 1\n"
                      "v -1 0 -.5\nv 1 0 -.5\nv 1 1 -.5\nv -1 1 -.5\nf 5 6 7 8\n");
    const auto said = [&](const std::vector<std::string>& more) {
        std::vector<std::string> line = {"precompute",    "wall.obj",          "-o",
                                         "by_itself.prt", "--face-resolution", "16"};
        line.insert(line.end(), more.begin(), more.end());
        return succeed(line).out;
    };
    const std::string refined = said({});
    EXPECT_NE(refined.find("refined: 8 vertices became "), std::string::npos) << refined;
    EXPECT_NE(refined.find("at most 45000 more for the mesh"), std::string::npos) << refined;
    EXPECT_GT(succeed("info by_itself.prt --json").json()["vertices"], 100);
    EXPECT_EQ(said({"--refine", "off"}).find("refined"), std::string::npos);
    EXPECT_EQ(succeed("info by_itself.prt --json").json()["vertices"], 8);
    // Who says how wants it so.
    EXPECT_EQ(said({"--max-edge", "100"}).find("at most"), std::string::npos);
}

TEST_F(Precompute, ToleranceAndResolutionChangeTheClusters) {
    EXPECT_EQ(made({"--tolerance", "1"})["clusters"], 6 * 8 * 8);
    EXPECT_EQ(made({"--tolerance", "0"})["clusters"], 6 * 16 * 16) << "down to single texels";
    EXPECT_EQ(made({"--face-resolution", "1", "--tolerance", "0"})["clusters"], 6);
}

TEST_F(Precompute, NormalsOfFacesReplaceTheFiles) {
    write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 0 -1\nvn 0 -1 0\nf 1//1 2//1 3//1\n");
    const auto radiance = [&](const std::vector<std::string>& crease) {
        succeed(command(crease));
        write("sky.hdr", hdr_file(64, 32, [](std::uint32_t, std::uint32_t y) {
                  const float sky = y < 16 ? 1.0f : 0.0f;
                  return Rgb{sky, sky, sky};
              }));
        succeed("relight new.prt sky.hdr -o lit.npy");
        return npy_values(read("lit.npy")).at(0)[0];
    };
    EXPECT_NEAR(radiance({"--crease", "180"}), 1.0f, 0.01f);
    EXPECT_NEAR(radiance({}), 0.0f, 0.01f);
}

TEST_F(Precompute, BadOptionsAreRefused) {
    for (const char* option : {"--tolerance", "--glossy-tolerance"}) {
        for (const char* value : {"nan", "-1", "inf", "-inf"})
            misuse(command({option, value}), std::string(option) + ": expected ");
        for (const char* value : {"much", "1x", "", "1,2"})
            misuse(command({option, value}), option);
    }
    for (const char* resolution : {"0", "16385", "4294967295"})
        misuse(command({"--face-resolution", resolution}), "--face-resolution: expected 1 to");
    misuse(command({"--face-resolution", "4294967296"}));
    misuse(command({"--face-resolution", "-16"}));
    misuse(command({"--face-resolution", "sixteen"}));
    misuse(command({"--crease", "flat"}), "--crease");
    misuse(command({"--tolerance", "1", "--tolerance", "2"}), "--tolerance");
}

TEST_F(Precompute, NumbersBeyondTheRaysRangeAreRefused) {
    misuse(command({"--view", "1e19,0,0,0,0,0"}), "--view: expected");
    misuse(command({"--view", "0,0,3,0,1e19,0"}), "--view: expected");
    write("mesh.obj", "v 1e19 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n");
    fail(command({}), {"mesh.obj: expected coordinates within 1.844e+18"});
}

TEST_F(Precompute, WorkThatWouldTakeHoursIsRefused) {
    succeed("generate knot -o . --vertices 20000 -q");
    const std::vector<std::string> knot = {"precompute", "knot.ply", "-o", "new.prt"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), knot.begin(), knot.end());
        return more;
    };
    const std::string error = misuse(with({"--tolerance", "0"}), "--tolerance: expected ").err;
    EXPECT_NE(error.find("6.29e+06 clusters"), std::string::npos) << error;
    EXPECT_NE(error.find(" rays and "), std::string::npos) << error;
}

TEST_F(Precompute, OptionsThatAreOftenMistaken) {
    misuse("precompute --floor mesh.obj -o new.prt",
           "--floor: expected auto or a number from 2 to 65535, got 'mesh.obj'; the mesh goes "
           "first: relumine "
           "precompute mesh.obj --floor");
    misuse(command({"--max-memory", "50"}),
           "--max-memory: expected a unit after the number, as in 50M or 50G, got '50'");
}

TEST_F(Precompute, BadFloorsAreRefused) {
    for (const char* n : {"0", "1", "100000", "4294967295"})
        misuse(command({"--floor", n}), "--floor: expected auto or a number from 2 to 65535");
    misuse(command({"--floor", "-3"}), "--floor");
    misuse(command({"--floor", "tiles"}), "--floor");
}

TEST_F(Precompute, TheOutputIsNeverTheInputNorAnythingButAScene) {
    for (const char* name : {"mesh.obj", "new.ply", "new"})
        misuse({"precompute", "mesh.obj", "-o", name},
               "--output: expected a name that ends in .prt, got");
    fs::create_symlink("mesh.obj", folder() / "link.prt");
    fail("precompute mesh.obj -o link.prt", {"link.prt"});
    fs::create_hard_link(folder() / "mesh.obj", folder() / "hard.prt");
    fail("precompute mesh.obj -o hard.prt", {"hard.prt"});
    ASSERT_EQ(::mkfifo((folder() / "pipe.prt").c_str(), 0600), 0);
    fail("precompute mesh.obj -o pipe.prt", {"pipe.prt", "not a regular file"});
}

TEST_F(Precompute, OutputsThatCannotBeWrittenAreFoundOutAtOnce) {
    fail("precompute mesh.obj -o missing/new.prt", {"missing/new.prt", "cannot write"});
    fail("precompute mesh.obj -o mesh.obj/new.prt", {"mesh.obj/new.prt", "cannot write"});
    fail("precompute mesh.obj -o /proc/new.prt", {"/proc/new.prt", "cannot write"});
    fs::create_directory(folder() / "folder.prt");
    fail("precompute mesh.obj -o folder.prt", {"folder.prt", "cannot write"});
    // Before the mesh is even looked at.
    fail("precompute missing.obj -o missing/new.prt", {"missing/new.prt"});
}

TEST_F(Precompute, AFullDiskLeavesTheOldScene) {
    succeed(command({}));
    fail(command({"--tolerance", "0.001"}), {"new.prt", "cannot write"}, {.max_file_bytes = 200});
    EXPECT_EQ(succeed("info new.prt --json").json()["face_resolution"], 16);
}

TEST_F(Precompute, ASecondRunReplacesTheFirst) {
    EXPECT_EQ(made({"--floor", "3"})["vertices"], 15);
    EXPECT_EQ(made({})["vertices"], 6);
    EXPECT_EQ(succeed("info new.prt --json").json()["vertices"], 6);
    EXPECT_EQ(files().size(), 3u) << "the mesh, the environment and the scene";
}

TEST_F(Precompute, TheSameInputGivesTheSameBytes) {
    succeed(command({"--floor", "9"}));
    const std::string first = read("new.prt");
    succeed(command({"--floor", "9"}));
    EXPECT_TRUE(read("new.prt") == first);
}

TEST_F(Precompute, StlHasZUpByCustomAndSaysSo) {
    // A triangle that lies in the plane z = 0, facing +Z.
    write("flat.stl", "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                      "vertex 0 1 0\nendloop\nendfacet\nendsolid s\n");
    const auto top_is_lit = [&](const std::vector<std::string>& up) {
        std::vector<std::string> command = {"precompute", "flat.stl",          "-o",
                                            "flat.prt",   "--face-resolution", "16"};
        command.insert(command.end(), up.begin(), up.end());
        const std::string said = succeed(command).out;
        write("top.hdr", hdr_file(64, 32, [](std::uint32_t, std::uint32_t y) {
                  return y < 2 ? Rgb{64.0f, 64.0f, 64.0f} : Rgb{0.0f, 0.0f, 0.0f};
              }));
        succeed("relight flat.prt top.hdr -o flat.npy");
        EXPECT_EQ(said.find("+Z is up, by the custom of .stl") != std::string::npos, up.empty());
        return npy_values(read("flat.npy")).at(0)[0] > 1.0f;
    };
    const auto said = [&](const std::vector<std::string>& more) {
        std::vector<std::string> command = {"precompute", "flat.stl",          "-o",
                                            "flat.prt",   "--face-resolution", "16"};
        command.insert(command.end(), more.begin(), more.end());
        return succeed(command).out;
    };
    EXPECT_NE(said({}).find("edges over 40 degrees are sharp, by the custom of .stl"),
              std::string::npos);
    EXPECT_EQ(said({"--crease", "180"}).find("edges over"), std::string::npos);
    EXPECT_EQ(said({"--crease", "30"}).find("edges over"), std::string::npos);
    EXPECT_TRUE(top_is_lit({}));
    EXPECT_TRUE(top_is_lit({"--up", "z"}));
    EXPECT_FALSE(top_is_lit({"--up", "y"}));
    misuse("precompute flat.stl -o new.prt --up w", "--up");
}

} // namespace
} // namespace relumine::app
