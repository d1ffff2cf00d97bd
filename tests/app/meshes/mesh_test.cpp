// `relumine mesh`, and what precompute does to meshes.
#include "tests/app/command.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

/// A box of 2 x 2 x 2 over y = 0, outward.
std::string box_obj() {
    return "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\n"
           "f 1 2 3 4\nf 5 8 7 6\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n";
}

/// The same with one face the wrong way round, one twice, one void.
std::string broken_obj() {
    return box_obj() + "f 1 2 3\nf 2 2 3\nf 4 1 5 8\n";
}

class MeshCommand : public AppTest {
protected:
    MeshCommand() {
        write("box.obj", box_obj());
        write("broken.obj", broken_obj());
        write("open.obj", box_obj().substr(0, box_obj().size() - 10));
        write("lamp.hdr", lamp_hdr(40));
        write("white.hdr", white_hdr());
    }
    [[nodiscard]] nlohmann::json info(const std::string& name) const {
        return succeed({"info", name, "--json"}).json();
    }
};

TEST_F(MeshCommand, TheDoctorSaysWhatIsOdd) {
    const nlohmann::json sound = info("box.obj")["diagnosis"];
    EXPECT_EQ(sound["closed"], true);
    EXPECT_EQ(sound["components"], 1);
    EXPECT_EQ(sound["wrongly_wound"], 0);
    const nlohmann::json broken = info("broken.obj")["diagnosis"];
    EXPECT_GT(broken["non_manifold_edges"], 0);
    EXPECT_GT(broken["repeated_sides"], 0);
    EXPECT_EQ(broken["zero_area"], 1);
    EXPECT_GT(broken["duplicates"], 0);
    const Result told = succeed("info broken.obj --picture faults.png");
    EXPECT_NE(told.out.find("edges of 3 or more"), std::string::npos) << told.described();
    EXPECT_NE(told.out.find("the first between vertices"), std::string::npos);
    EXPECT_EQ(read("faults.png").substr(1, 3), "PNG");
    EXPECT_EQ(info("open.obj")["diagnosis"]["boundary_edges"], 4);
    misuse("info box.obj --picture box.obj", "--picture");
}

TEST_F(MeshCommand, RepairMendsOnce) {
    const nlohmann::json report = succeed("mesh repair broken.obj -o mended.ply --json").json();
    EXPECT_EQ(report["zero_area"], 1);
    EXPECT_GT(report["duplicates"], 0);
    EXPECT_EQ(report["triangles"], 12);
    const nlohmann::json mended = info("mended.ply")["diagnosis"];
    EXPECT_EQ(mended["closed"], true);
    EXPECT_EQ(mended["repeated_sides"], 0);
    EXPECT_NE(succeed("mesh repair mended.ply -o again.ply").out.find("nothing to repair"),
              std::string::npos);
    EXPECT_EQ(info("again.ply")["triangles"], 12);
    EXPECT_EQ(
        succeed("mesh repair open.obj -o whole.obj --fill-holes 4 --json").json()["new_triangles"],
        2);
    EXPECT_EQ(info("whole.obj")["diagnosis"]["closed"], true);
    misuse("mesh repair box.obj -o a.stl", "--output");
    misuse("mesh repair box.obj -o a.ply --fill-holes 2", "--fill-holes");
    fail("mesh repair box.obj -o box.obj", {"box.obj"});
}

TEST_F(MeshCommand, ARimThatIsMetTwiceIsOneLine) {
    // Two tetrahedra without their lids that share a vertex of the rims.
    write("twice.obj", "v 0 0 0\nv 2 0 0\nv 1 0 2\nv 1 2 1\nv -2 0 0\nv -1 0 2\nv -1 2 1\n"
                       "f 1 4 2\nf 2 4 3\nf 3 4 1\nf 5 7 1\nf 1 7 6\nf 6 7 5\n");
    fail("mesh repair twice.obj -o a.ply --fill-holes 3",
         {"twice.obj: expected holes whose rims the surface meets once"});
}

TEST_F(MeshCommand, AttributesAreKeptInObj) {
    write("a.mtl", "newmtl red\nKd 0.5 0.25 0.125\nnewmtl shiny\nKd 0.5\nKs 0.25\nNs 50\n");
    write("parts.obj",
          "mtllib a.mtl\nv 0 0 0 0.5 0.25 1\nv 1 0 0 0 0 0\nv 0 0 1 1 1 1\nv 1 0 1 1 1 1\n"
          "vt 0 0\nvt 1 0\nvt 0 1\nvt 5 5\nvt 6 5\nvt 5 6\n"
          "o left\nusemtl red\nf 1/1 3/3 2/2\no right\nusemtl shiny\nf 2/4 3/5 4/6\n");
    succeed("mesh repair parts.obj -o copy.obj");
    nlohmann::json before = info("parts.obj"), after = info("copy.obj");
    EXPECT_EQ(after, before);
    EXPECT_EQ(after["groups"], (nlohmann::json{"left", "right"}));
    EXPECT_EQ(after["colors"], true);
    const Result flat = succeed("mesh repair parts.obj -o copy.ply");
    EXPECT_NE(flat.err.find("left out: materials"), std::string::npos) << flat.described();
}

TEST_F(MeshCommand, CreasesAndSimpler) {
    succeed("mesh repair box.obj -o flat.ply --crease 40");
    EXPECT_EQ(info("flat.ply")["vertices"], 24);
    EXPECT_EQ(info("flat.ply")["diagnosis"]["closed"], true);
    succeed("generate colonnade -o . --vertices 2000 -q");
    const std::int64_t all = info("colonnade.ply")["vertices"];
    const Result fewer = succeed("mesh simplify colonnade.ply -o few.ply --vertices 1500");
    EXPECT_LT(info("few.ply")["vertices"].get<std::int64_t>(), all) << fewer.described();
    misuse("mesh simplify box.obj -o a.ply --vertices 3", "--vertices");
    misuse("mesh repair box.obj -o a.ply --crease 181", "--crease");
}

TEST_F(MeshCommand, RefinedFloorsHaveShadows) {
    const auto surface_error = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments = {
            "precompute", "box.obj", "-o",          "scene.prt", "--crease",          "40",
            "--floor",    "2",       "--tolerance", "0.03",      "--face-resolution", "64",
            "--json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const nlohmann::json report = succeed(arguments).json();
        EXPECT_EQ(report.contains("refine"), more[1] != "off");
        const nlohmann::json verified = succeed("verify scene.prt lamp.hdr --json").json();
        EXPECT_EQ(verified["surface"]["points"], 500);
        return verified["surface"]["relative_l2"].get<double>();
    };
    const double coarse = surface_error({"--refine", "off"});
    const double fine = surface_error({"--refine", "0", "--vertices", "600"});
    EXPECT_LT(fine, 0.5 * coarse);
    const nlohmann::json scene = succeed("info scene.prt --check --json").json();
    EXPECT_LE(scene["vertices"], 600);
    EXPECT_GT(scene["vertices"], 580);
    EXPECT_EQ(scene["floor"], 2);
    // The floor is still known: it fades, and has its own albedo.
    succeed("relight scene.prt white.hdr -o a.png --size 64x48");
    succeed("relight scene.prt white.hdr -o b.png --size 64x48 --floor-albedo 0.9");
    EXPECT_NE(read("a.png"), read("b.png"));
}

TEST_F(MeshCommand, RefinedForAnEnvironment) {
    std::vector<std::string> arguments = {"mesh",        "refine", "parts.obj",  "-o",  "any.ply",
                                          "--tolerance", "0",      "--vertices", "400", "-q"};
    // A shelf over a floor.
    write("parts.obj", "v -4 0 -4\nv 4 0 -4\nv 4 0 4\nv -4 0 4\nv -1 1 -1\nv 1 1 -1\nv 1 1 1\n"
                       "v -1 1 1\nf 4 3 2 1\nf 8 7 6 5\n");
    succeed(arguments);
    arguments[4] = "lamp.ply";
    arguments.insert(arguments.end(), {"--refine-for", "sun.hdr"});
    // A lamp halfway up; that of lamp.hdr stands on the horizon.
    write("sun.hdr", hdr_file(128, 64, [](std::uint32_t x, std::uint32_t y) {
              const float radiance = x == 40 && y == 18 ? 512.0f : 0.0f;
              return Rgb{radiance, radiance, radiance};
          }));
    succeed(arguments);
    EXPECT_LE(info("lamp.ply")["vertices"], 400);
    EXPECT_GT(info("lamp.ply")["vertices"], 380);
    EXPECT_NE(read("any.ply"), read("lamp.ply"));
    arguments.back() = "no.hdr";
    fail(arguments, {"no.hdr"});
    misuse("precompute box.obj -o a.prt --refine-for lamp.hdr", "--refine-for");
    misuse("precompute box.obj -o a.prt --max-edge 1 --refine-for lamp.hdr", "--refine-for");
}

TEST_F(MeshCommand, GlbIsWrittenToo) {
    succeed("mesh repair box.obj -o box.glb --crease 40");
    const nlohmann::json box = info("box.glb");
    EXPECT_EQ(box["vertices"], 24);
    EXPECT_EQ(box["triangles"], 12);
    EXPECT_EQ(box["diagnosis"]["closed"], true);
    succeed("mesh repair box.glb -o box.ply");
    EXPECT_EQ(info("box.ply")["diagnosis"], box["diagnosis"]);
}

TEST_F(MeshCommand, SurfaceErrorsAreRepeated) {
    succeed("precompute box.obj -o scene.prt --face-resolution 16 --refine off");
    const auto surface = [&](const std::string& samples) {
        return succeed({"verify", "scene.prt", "lamp.hdr", "--samples", samples, "--json"})
            .json()["surface"];
    };
    EXPECT_EQ(surface("20"), surface("20"));
    EXPECT_EQ(surface("20")["points"], 20);
    EXPECT_EQ(surface("0")["points"], 500);
    EXPECT_NE(succeed("verify scene.prt white.hdr").out.find("between the vertices"),
              std::string::npos);
}

TEST_F(MeshCommand, SimplifiedReceiversHaveTheShadowsOfAll) {
    succeed("generate colonnade -o . --vertices 3000 -q");
    const std::int64_t all = info("colonnade.ply")["triangles"];
    succeed("precompute colonnade.ply -o light.prt --simplify 2500 --tolerance 0.03 "
            "--face-resolution 64");
    const nlohmann::json scene = succeed("info light.prt --check --json").json();
    EXPECT_LT(scene["triangles"], all);
    // Exact light knows the blockers, so the vertices agree with it.
    EXPECT_LT(succeed("verify light.prt lamp.hdr --samples 200 --json").json()["relative_l2"], 0.1);
}

TEST_F(MeshCommand, WindingThatMakesBlackIsWarnedOf) {
    const Result sound = succeed("precompute box.obj -o a.prt --face-resolution 8 --refine off");
    EXPECT_EQ(sound.err.find("wound"), std::string::npos) << sound.described();
    std::string inside_out = box_obj();
    inside_out.replace(inside_out.find("f 5 8 7 6"), 9, "f 6 7 8 5");
    write("inside.obj", inside_out);
    const Result black = succeed("precompute inside.obj -o a.prt --face-resolution 8 --refine off");
    EXPECT_NE(black.err.find("2 of 12 triangles are wound the wrong way round"), std::string::npos)
        << black.described();
}

TEST_F(MeshCommand, LimitsThatContradictEachOtherAreRefused) {
    misuse("precompute box.obj -o a.prt --vertices 100", "--vertices");
    misuse("precompute box.obj -o a.prt --refine off --vertices 100", "--vertices");
    misuse("precompute box.obj -o a.prt --curved", "--curved");
    for (const char* error : {"2", "-1", "nan", "on"})
        misuse({"precompute", "box.obj", "-o", "a.prt", "--refine", error},
               "--refine: expected off or an error from 0 to 1");
    misuse("precompute box.obj -o a.prt --refine --view auto --receivers pixels:8x8", "--refine");
    fail("precompute box.obj -o a.prt --refine --vertices 5",
         {"box.obj: expected a limit of at least the mesh's 8 vertices, got 5"});
    write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    fail("mesh refine flat.obj -o a.ply",
         {"flat.obj: expected a triangle with an area to refine, got none"});
    EXPECT_NE(succeed("mesh refine box.obj -o same.ply --crease 40")
                  .out.find("no edge needs to be split"),
              std::string::npos)
        << "a convex mesh with smooth normals of 40 degrees";
}

} // namespace
} // namespace relumine::app
