// Meshes with the coordinates of maps: every place that a user gives or gets counts as in the file.
// A mesh at the origin, asked about the same places without the offset, has the answers.
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/vec3.hpp>
#include <gmock/gmock.h>

#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

using testing::HasSubstr;

constexpr glm::dvec3 Place(691236.0, 520.0, 5334568.0);

/// An octahedron over a plate, so that light differs.
std::string mesh_at(const glm::dvec3& place) {
    std::string text;
    for (const glm::dvec3& p : {glm::dvec3(1, 0, 0),
                                {-1, 0, 0},
                                {0, 1, 0},
                                {0, -1, 0},
                                {0, 0, 1},
                                {0, 0, -1},
                                {-2, -1, -2},
                                {-2, -1, 3},
                                {2, -1, 3},
                                {2, -1, -2}})
        text += fmt::format("v {} {} {}\n", place.x + p.x, place.y + p.y, place.z + p.z);
    return text + "f 1 3 5\nf 5 3 2\nf 2 3 6\nf 6 3 1\nf 5 4 1\nf 2 4 5\nf 6 4 2\nf 1 4 6\n"
                  "f 7 8 9\nf 7 9 10\n";
}

/// "0.5,1,2" of a place on the mesh at the origin.
std::string text_of(const glm::dvec3& place, const glm::dvec3& offset) {
    return fmt::format("{},{},{}", offset.x + place.x, offset.y + place.y, offset.z + place.z);
}

class FarPlaces : public AppTest {
protected:
    FarPlaces() {
        write("near.obj", mesh_at(glm::dvec3(0.0)));
        write("far.obj", mesh_at(Place));
        write("lamp.hdr", lamp_hdr(40));
    }
    void precompute(const std::string& name, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments = {
            "precompute",  name + ".obj", "-o",        name + ".prt", "--face-resolution", "16",
            "--tolerance", "0.1",         "--bounces", "0",           "--refine",          "off"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        succeed(arguments);
    }
    /// `relumine relight` of either mesh with options that name places; what it wrote is the same.
    void expect_same(const std::string& output, const std::string& option, const glm::dvec3& place,
                     const std::vector<std::string>& more) const {
        std::vector<std::string> files;
        for (const auto& [name, offset] :
             {std::pair("near", glm::dvec3(0.0)), std::pair("far", Place)}) {
            std::vector<std::string> arguments = {
                "relight", std::string(name) + ".prt", "lamp.hdr", "-o", output,
                option,    text_of(place, offset)};
            arguments.insert(arguments.end(), more.begin(), more.end());
            succeed(arguments);
            files.push_back(read(output));
        }
        EXPECT_EQ(files[0], files[1]) << option;
    }
};

TEST_F(FarPlaces, EyesAndTargets) {
    precompute("near");
    precompute("far");
    expect_same("seen.png", "--eye", {3.3, 1.25, 4.5}, {"--size", "24x18"});
    expect_same("seen.png", "--target", {0.5, 0.25, -0.5}, {"--size", "24x18"});
    succeed({"relight", "near.prt", "lamp.hdr", "-o", "auto.png", "--size", "24x18"});
    EXPECT_NE(read("auto.png"), read("seen.png"));
    EXPECT_THAT(succeed({"relight", "far.prt", "lamp.hdr", "-o", "seen.png", "--size", "8x8",
                         "--eye", text_of({0.1, 0.2, 0.1}, Place)})
                    .err,
                HasSubstr("the eye 691236.1,520.2,5334568.1 is inside of the mesh"));
}

TEST_F(FarPlaces, ViewsOfAPrecompute) {
    for (const auto& [name, offset] :
         {std::pair("near", glm::dvec3(0.0)), std::pair("far", Place)}) {
        precompute(name, {"--receivers", "pixels:12x9:1", "--view",
                          text_of({2.5, 1.5, 3.0}, offset) + "," + text_of({0, 0, 0}, offset)});
        succeed(
            {"relight", std::string(name) + ".prt", "lamp.hdr", "-o", std::string(name) + ".npy"});
    }
    EXPECT_EQ(read("near.npy"), read("far.npy"));
    EXPECT_THAT(succeed("info far.prt").out,
                HasSubstr("view                from (691238.5, 521.5, 5334571) to (691236, 520, "
                          "5334568), 35 degrees"));
    const nlohmann::json info = succeed("info far.prt --json").json();
    EXPECT_EQ(info["layout"]["eye"], (nlohmann::json{691238.5, 521.5, 5334571.0}));
}

TEST_F(FarPlaces, BoxesOfGrids) {
    for (const auto& [name, offset] :
         {std::pair("near", glm::dvec3(0.0)), std::pair("far", Place)}) {
        precompute(name, {"--receivers", "grid:2x2x1:" + text_of({-2, 1.25, -2}, offset) + "," +
                                             text_of({2, 2.25, 2}, offset)});
        succeed({"relight", std::string(name) + ".prt", "lamp.hdr", "-o",
                 std::string(name) + ".npy", "--harmonics", std::string(name) + ".json"});
    }
    EXPECT_EQ(read("near.npy"), read("far.npy"));
    const nlohmann::json probes = nlohmann::json::parse(read("far.json"))["object"];
    EXPECT_EQ(probes["userData"]["low"], (nlohmann::json{691234.0, 521.25, 5334566.0}));
    EXPECT_EQ(probes["children"][0]["matrix"][12], 691235.0);
    EXPECT_EQ(probes["children"][0]["matrix"][14], 5334568.0);
}

TEST_F(FarPlaces, WhoAndPathsAndReports) {
    precompute("near");
    precompute("far");
    write("layers.json", R"({"version": 1, "layers": []})");
    const Result who = succeed({"edit", "far.prt", "lamp.hdr", "layers.json", "-o", "who.exr",
                                "--who", text_of({1.1, 0.1, 0.0}, Place)});
    EXPECT_THAT(who.out, HasSubstr("what lights vertex 0 (691237, 520, 5334568)"));
    for (const auto& [name, offset] :
         {std::pair("near", glm::dvec3(0.0)), std::pair("far", Place)}) {
        const auto key = [&](int frame, const glm::dvec3& eye) {
            return fmt::format(R"({{"frame": {}, "eye": [{}], "target": [{}]}})", frame,
                               text_of(eye, offset), text_of({0, 0, 0}, offset));
        };
        write("path.json",
              R"({"version": 1, "frames": [)" + key(0, {0, 1, 4}) + "," + key(1, {3, 1, 3}) + "]}");
        succeed({"animate", std::string(name) + ".prt", "lamp.hdr", "-o",
                 std::string(name) + ".%d.png", "--camera-path", "path.json", "--size", "12x9"});
    }
    for (const char* const frame : {"0", "1"})
        EXPECT_EQ(read(std::string("near.") + frame + ".png"),
                  read(std::string("far.") + frame + ".png"));
    EXPECT_NE(read("far.0.png"), read("far.1.png"));
    const nlohmann::json info = succeed("info far.obj --json").json();
    EXPECT_EQ(info["min"], (nlohmann::json{691234.0, 519.0, 5334566.0}));
    EXPECT_THAT(succeed("info far.obj").out,
                HasSubstr("box                 (691234, 519, 5334566) to (691238, 521, 5334571)"));
}

/// A flat town whose heights are along Z, as map programs write it.
TEST_F(FarPlaces, MapsWithHeightsAlongZAreDoubted) {
    std::string town;
    for (const glm::dvec3& p :
         {glm::dvec3(0, 0, 0.5), {900.25, 0, 0.5}, {900.25, 800, 9.5}, {0, 800, 9.5}})
        town += fmt::format("v {} {} {}\n", p.x - 15593.52441, p.y - 81362.74536, p.z);
    write("town.obj", town + "f 1 2 3 4\n");
    const char* const doubt = "+Y is taken as up, but coordinates are those of a map, with heights "
                              "along Z; --up z turns it";
    EXPECT_THAT(succeed("info town.obj").out, HasSubstr(doubt));
    EXPECT_THAT(succeed("info far.obj").out, testing::Not(HasSubstr("of a map")));
    precompute("town", {"--up", "z"});
}

} // namespace
} // namespace relumine::app
