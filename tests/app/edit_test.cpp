// `relumine edit`: what it changes and what it refuses.
#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

class Edit : public AppTest {
protected:
    Edit() {
        write("mesh.obj", octahedron_obj());
        write("white.hdr", white_hdr());
        succeed({"precompute", "mesh.obj", "-o", "scene.prt", "--face-resolution", "32", "-q"});
    }
    [[nodiscard]] static std::vector<std::string> command(const std::vector<std::string>& options) {
        std::vector<std::string> arguments = {"edit", "scene.prt", "white.hdr", "-o", "new.npy"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        return arguments;
    }
};

TEST_F(Edit, BrightensTheSideThatFacesTheDisc) {
    const nlohmann::json report =
        succeed(command({"--disc", "1,0,0", "--radius", "20", "--gain", "4,2,1", "--json"})).json();
    for (const char* key : {"clusters_touched", "clusters", "seconds_edit", "seconds_full"})
        EXPECT_TRUE(report.contains(key)) << key;
    const auto values = npy_values(read("new.npy"));
    ASSERT_EQ(values.size(), 6u);
    // +X sees the disc face on: 1 + (gain - 1) sin(20 degrees)^2; the texels' rim costs some.
    EXPECT_NEAR(values[0][0], 1.0 + 3.0 * 0.117, 0.05);
    EXPECT_NEAR(values[0][1], 1.0 + 1.0 * 0.117, 0.02);
    EXPECT_NEAR(values[0][2], 1.0, 5e-3);
    EXPECT_NEAR(values[1][0], 1.0, 5e-3) << "-X does not see it";
    for (const std::size_t side : {2u, 3u, 4u, 5u})
        EXPECT_LT(values[side][0], values[0][0]) << side;
}

TEST_F(Edit, GainZeroAndAWholeSphereTurnTheLightOff) {
    succeed(command({"--disc", "0,1,0", "--radius", "180", "--gain", "0"}));
    for (const auto& value : npy_values(read("new.npy")))
        EXPECT_NEAR(value[0], 0.0f, 1e-5f);
}

TEST_F(Edit, TheSavedEnvironmentGivesTheSame) {
    for (const char* name : {"new.exr", "new.hdr"}) {
        succeed(command({"--disc", "0,1,1", "--gain", "8", "--save-env", name}));
        succeed({"relight", "scene.prt", name, "-o", "again.npy"});
        EXPECT_LT(relative_l2(npy_values(read("again.npy")), npy_values(read("new.npy"))), 5e-3) << name;
    }
}

TEST_F(Edit, BadOptionsAreRefused) {
    for (const char* disc : {"0,0,0", "up", "0,1", "0,1,0,0", "nan,0,0", "inf,0,0"})
        misuse(command({"--disc", disc}), "--disc");
    for (const char* gain : {"nan", "inf", "-1", "1,2", "1,2,-3", "much"})
        misuse(command({"--disc", "0,1,0", "--gain=" + std::string(gain)}), "--gain");
    for (const char* radius : {"nan", "-1", "181", "wide", "inf"})
        misuse(command({"--disc", "0,1,0", "--radius", radius}), "--radius");
    fail({"edit", "scene.prt", "white.hdr", "-o", "new.bmp", "--disc", "0,1,0"}, {"new.bmp"});
    fail({"edit", "mesh.obj", "white.hdr", "-o", "new.npy", "--disc", "0,1,0"}, {"mesh.obj"});
}

TEST_F(Edit, ABadSavedEnvironmentIsFoundOutBeforeAnythingIsWritten) {
    for (const char* name : {"saved.txt", "saved", "missing/saved.exr", "new.npy", ".", "/proc/saved.exr"})
        fail(command({"--disc", "0,1,0", "--save-env", name}));
    fail(command({"--disc", "0,1,0", "--save-env", "white.hdr"}), {"white.hdr"});
    fail({"edit", "scene.prt", "white.hdr", "-o", "same.exr", "--size", "8x8", "--disc", "0,1,0",
          "--save-env", "./same.exr"},
         {"same.exr"});
}

TEST_F(Edit, GainBeyondWhatAFloatHoldsIsRefused) {
    write("white.hdr", hdr_file(64, 32, [](std::uint32_t, std::uint32_t) { return Rgb{4.0f, 4.0f, 4.0f}; }));
    fail(command({"--disc", "0,1,0", "--gain", "3e38"}), {"expected"});
    misuse(command({"--disc", "0,1,0", "--gain", "1e39"}), "--gain");
}

} // namespace
} // namespace relumine::app
