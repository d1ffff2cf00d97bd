// `relumine export runtime`: lean files, and what they leave out.
#include <algorithm>
#include <filesystem>
#include <vector>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include "mesh/load.h"
#include "prt/scene/relighting_file.h"
#include "prt/scene/section_reader.h"
#include "tests/app/command.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

using ::testing::HasSubstr;

class ExportRuntime : public AppTest {
protected:
    ExportRuntime() { write("mesh.obj", octahedron_obj()); }

    void precompute(const std::vector<std::string>& options) {
        std::vector<std::string> arguments = {
            "precompute", "mesh.obj", "-o",  "scene.prt", "--face-resolution",
            "32",         "--refine", "off", "-q"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        succeed(arguments);
    }
};

TEST_F(ExportRuntime, KeepsTheLightAndTheAlbedoOfBounces) {
    precompute({"--bounces", "0.05", "--floor", "9", "--material", "lambert:albedo=0.3"});
    const nlohmann::json report = succeed("export runtime scene.prt -o lean.relight --json").json();
    EXPECT_EQ(report["bytes"], std::filesystem::file_size(folder() / "lean.relight"));
    EXPECT_LT(report["bytes"], report["bytes_before"]);
    const prt::RelightingScene lean =
        prt::relighting_scene_of(prt::SectionReader(folder() / "lean.relight"));
    EXPECT_EQ(report["receivers"], lean.scene.receivers.size());
    EXPECT_TRUE(lean.scene.bounces);
    ASSERT_EQ(lean.albedo.size(), lean.scene.receivers.size());
    EXPECT_NEAR(lean.albedo[0].r, 0.3f, 1e-3f);
}

TEST_F(ExportRuntime, SaysWhatItLeavesOut) {
    precompute({"--view", "auto", "--material", "ggx:roughness=0.5"});
    const auto run = succeed("export runtime scene.prt -o lean.relight");
    EXPECT_THAT(run.err, HasSubstr("highlights are left out"));
}

TEST_F(ExportRuntime, RefusesOtherNamesAndFiles) {
    fail("export runtime mesh.obj -o lean.relight", {"mesh.obj: expected"});
    misuse("export runtime mesh.obj -o lean.prt", "--output");
}

class ExportThree : public AppTest {};

/// A wall of two triangles above another: both are too coarse for their light.
TEST_F(ExportThree, TheMeshHasTheReceiversAsItsVertices) {
    write("wall.mtl", "newmtl paint\nKd 0.5 0.25 0.125\n");
    write("wall.obj", "mtllib wall.mtl\nv 0 0 0\nv 0 0 4\nv 4 0 4\nv 4 0 0\n"
                      "v 1 1 1\nv 2 1 1\nv 2 1 2\nv 1 1 2\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                      "usemtl paint\ng ground\nf 1/1 2/2 3/3 4/4\ng roof\nf 5 6 7 8\n");
    const nlohmann::json report = succeed("export three wall.obj -o lit --json").json();
    const prt::RelightingScene lean =
        prt::relighting_scene_of(prt::SectionReader(folder() / "lit/scene.relight"));
    EXPECT_EQ(report["receivers"], lean.scene.receivers.size());
    const mesh::TriangleMesh mesh = mesh::load(folder() / "lit/scene.glb");
    EXPECT_GT(mesh.num_vertices(), 20u) << "it is refined";
    EXPECT_THAT(mesh.groups, testing::ElementsAre("ground", "roof"));
    EXPECT_EQ(mesh.materials.at(0).base_color, glm::vec3(0.5f, 0.25f, 0.125f));
    // The wall's front and back are lit by themselves. Both would draw both sides at one place.
    for (const std::uint32_t material : mesh.triangle_materials)
        EXPECT_FALSE(mesh.materials[material].is_double_sided);
    const std::vector<glm::vec3>& receivers = lean.scene.mesh.positions;
    for (std::size_t i = 0; i < mesh.num_vertices(); i += 97)
        EXPECT_TRUE(std::ranges::any_of(receivers, [&](const glm::vec3& place) {
            return glm::distance(mesh.positions[i], place) < 1e-3f;
        })) << i;
    succeed("precompute wall.obj -o scene.prt --floor 5 --refine off -q");
    EXPECT_EQ(succeed("export three scene.prt -o lit --json").json()["receivers"], 8 + 25);
    EXPECT_EQ(mesh::load(folder() / "lit/scene.glb").num_vertices(), 8u + 25u);
}

TEST_F(ExportThree, RefusesOtherReceiversAndNames) {
    write("mesh.obj", octahedron_obj());
    write("file", "");
    succeed("precompute mesh.obj -o scene.prt --receivers pixels:8x8 --view auto -q");
    fail("export three scene.prt -o lit", {"scene.prt: expected vertices as receivers, got"});
    misuse("export three mesh.obj -o file", "expected a folder");
    misuse("export three a.hdr -o lit", "expected a scene (.prt) or a mesh");
    fail("export three none.obj -o lit", {"none.obj"});
}

} // namespace
} // namespace relumine::app
