// `relumine export runtime`: lean files, and what they leave out.
#include <filesystem>

#include <gmock/gmock.h>

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

} // namespace
} // namespace relumine::app
