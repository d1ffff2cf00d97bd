#include "mesh/load.h"

#include <cmath>

#include <sys/stat.h>

#include "tests/mesh/mesh_files.h"

namespace relumine::mesh {
namespace {

using LoadTest = MeshFileTest;

TEST_F(LoadTest, TellsTheFormatByTheExtensionInAnyCase) {
    expect_box(load(write("box.ply", box_ply())));
    expect_box(load(write("box.PLY", box_ply({.format = "binary_big_endian"}))));
    expect_box(load(write("box.oFf", "OFF\n8 7 0\n" + box_vertex_lines() + box_face_lines())));
    EXPECT_EQ(load(write("box.STL", box_binary_stl())).num_vertices(), 8u);
    EXPECT_EQ(load(write("triangle.Obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3")).num_triangles(),
              1u);
}

TEST_F(LoadTest, NamesTheFileInEveryError) {
    expect_refusal([this] { return load(write("broken.obj", "v 0 0\n")); },
                   "broken.obj: expected 3, 4, 6 or 7 numbers");
    expect_refusal(
        [this] { return load(write("box.fbx", "")); },
        "box.fbx: expected a mesh file (.glb, .gltf, .obj, .off, .ply or .stl), got '.fbx'");
    expect_refusal([this] { return load(write("box", "")); }, "got ''");
    try {
        static_cast<void>(load(folder_ / "missing.ply"));
        FAIL() << "a missing file was accepted";
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("missing.ply: cannot read: No such file"));
    }
    try {
        static_cast<void>(load(folder_ / "missing"));
        FAIL() << "a missing file was accepted";
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("missing: cannot read: No such file"))
            << "before anything about its extension";
    }
}

TEST_F(LoadTest, RefusesFoldersPipesAndDevices) {
    std::filesystem::create_directory(folder_ / "folder.ply");
    EXPECT_THROW(static_cast<void>(load(folder_ / "folder.ply")), std::runtime_error);
    ASSERT_EQ(::mkfifo((folder_ / "pipe.ply").c_str(), 0600), 0);
    EXPECT_THROW(static_cast<void>(load(folder_ / "pipe.ply")), std::runtime_error);
    std::filesystem::create_symlink("/dev/zero", folder_ / "zero.ply");
    EXPECT_THROW(static_cast<void>(load(folder_ / "zero.ply")), std::runtime_error);
}

/// The same mesh at sizes where products of coordinates have no place in a float.
TEST_F(LoadTest, TinyMeshesAreEnlarged) {
    const auto box_of = [](float size) {
        TriangleMesh mesh = ply(box_ply());
        std::string text;
        for (const glm::vec3& p : mesh.positions)
            text += fmt::format("v {} {} {}\n", size * p.x, size * p.y, size * p.z);
        for (const auto& t : mesh.triangles)
            text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
        return obj(text);
    };
    const TriangleMesh box = box_of(1.0f);
    for (const int exponent : {-42, -64, -100, -125}) {
        const TriangleMesh tiny = box_of(std::ldexp(1.0f, exponent));
        EXPECT_EQ(defect(tiny), "");
        EXPECT_EQ(tiny.normals, box.normals) << exponent;
        for (std::size_t i = 0; i < box.num_vertices(); ++i)
            EXPECT_EQ(2.0f * tiny.positions[i], box.positions[i]) << exponent;
        EXPECT_THAT(tiny.warnings, testing::ElementsAre(testing::HasSubstr("the mesh is read 2^")));
    }
    const TriangleMesh small = box_of(0x1p-40f);
    EXPECT_EQ(small.positions[1].x, 0x1p-40f);
    EXPECT_THAT(small.warnings, testing::IsEmpty());
    EXPECT_THAT(box_of(0.0f).warnings, testing::IsEmpty()) << "a point has no size";
}

TEST_F(LoadTest, LibrariesStaySilent) {
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    expect_box(load(write("box.ply", box_ply())));
    EXPECT_THROW(static_cast<void>(load(write("broken.ply", "ply\n"))), std::runtime_error);
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

} // namespace
} // namespace relumine::mesh
