// `relumine generate`: what it makes and what it refuses.
#include <set>

#include "tests/app/command.h"
#include "tests/app/formats.h"

namespace relumine::app {
namespace {

namespace fs = std::filesystem;

class Generate : public AppTest {};

TEST_F(Generate, AllMakesEveryScenesAndEnvironmentsFile) {
    const nlohmann::json report =
        succeed("generate all -o deep/er --vertices 1000 --face-resolution 16 --json").json();
    std::set<std::string> names;
    for (const nlohmann::json& file : report["files"]) {
        const fs::path path = file["file"].get<std::string>();
        names.insert(path.filename().string());
        const nlohmann::json info = succeed({"info", path.string(), "--json"}).json();
        if (path.extension() != ".exr") {
            EXPECT_EQ(info["vertices"], file["vertices"]);
            EXPECT_NEAR(info["vertices"].get<double>(), 1000.0, 40.0);
            EXPECT_EQ(info["diagnosis"]["isolated_vertices"], 0);
        } else {
            EXPECT_EQ(info["num_nan"], 0);
            EXPECT_EQ(info["num_negative"], 0);
            EXPECT_GT(info["mean_luminance"], 0.0);
        }
    }
    for (const char* name :
         {"colonnade.ply", "knot.ply", "blob.ply", "sphere.ply", "still_life.glb", "sun_sky.exr",
          "soft_boxes.exr", "small_light.exr", "constant.exr", "sun_sky_latlong.exr"})
        EXPECT_TRUE(names.contains(name)) << name;
    EXPECT_EQ(names.size(), static_cast<std::size_t>(
                                std::distance(fs::directory_iterator(folder() / "deep/er"), {})));
}

TEST_F(Generate, TheSameEveryTime) {
    for (const char* where : {"one", "two"}) {
        succeed({"generate", "knot", "-o", where, "--vertices", "1000", "--threads",
                 where[0] == 'o' ? "1" : "2"});
        succeed({"generate", "sun_sky", "-o", where, "--face-resolution", "16"});
    }
    EXPECT_TRUE(read("one/knot.ply") == read("two/knot.ply"));
    EXPECT_TRUE(read("one/sun_sky.exr") == read("two/sun_sky.exr"));
}

TEST_F(Generate, SizesOfTheEnvironmentFiles) {
    succeed("generate constant -o . --face-resolution 8");
    EXPECT_EQ(exr_size(read("constant.exr")), (Size{8, 48}));
    EXPECT_EQ(exr_size(read("constant_latlong.exr")), (Size{32, 16}));
}

TEST_F(Generate, BadSizesAreRefusedAndMakeNoFolder) {
    for (const char* vertices : {"0", "999", "5000001", "18446744073709551615"})
        misuse({"generate", "blob", "-o", "new", "--vertices", vertices}, "--vertices");
    misuse("generate blob -o new --vertices -5", "--vertices");
    misuse("generate blob -o new --vertices many", "--vertices");
    for (const char* resolution : {"0", "16385"})
        misuse({"generate", "sun_sky", "-o", "new", "--face-resolution", resolution},
               "--face-resolution");
    misuse("generate sun_sky -o new --face-resolution -1", "--face-resolution");
}

TEST_F(Generate, FoldersThatCannotBe) {
    write("file", "in the way");
    fail("generate blob -o file --vertices 1000", {"file"});
    fail("generate blob -o file/folder --vertices 1000", {"file/folder"});
    fail("generate blob -o /proc/folder --vertices 1000", {"/proc/folder"});
    fs::create_directories(folder() / "taken/blob.ply");
    fail("generate blob -o taken --vertices 1000", {"taken/blob.ply", "cannot write"});
}

TEST_F(Generate, AFullDiskLeavesTheOldFiles) {
    write("blob.ply", "precious");
    write("constant.exr", "precious");
    fail("generate blob -o . --vertices 1000", {"blob.ply"}, {.max_file_bytes = 100});
    fail("generate constant -o . --face-resolution 8", {"constant.exr"}, {.max_file_bytes = 100});
}

} // namespace
} // namespace relumine::app
