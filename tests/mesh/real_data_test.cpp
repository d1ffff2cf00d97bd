// Real meshes, which are not part of the repository: counts of vertices and triangles that were
// found with other readers, and those of ours where vertices have several normals or colours.
#include <ctime>

#include "mesh/floor.h"
#include "tests/mesh/mesh_files.h"
#include "tests/real_data.h"

namespace relumine::mesh {
namespace {

struct RealMesh {
    const char* path;
    std::size_t num_vertices;
    /// Corners - 2, summed over all faces
    std::size_t num_triangles;
};

constexpr RealMesh RealMeshes[] = {
    {"stanford/bun_zipper.ply", 35947, 69451},
    {"stanford/bun_zipper_res2.ply", 8171, 16301},
    {"stanford/bun_zipper_res3.ply", 1889, 3851},
    {"stanford/bun_zipper_res4.ply", 453, 948},
    {"stanford/happy_vrip_res3.ply", 32328, 67240},
    {"stanford/happy_vrip_res4.ply", 7108, 15536},
    {"stanford/dragon_vrip_res2.ply", 100250, 202520},
    {"stanford/dragon_vrip_res4.ply", 5205, 11102},
    {"ugly/cgal_elephant-with-holes.off", 2798, 4463},
    {"ugly/cgal_mech-holes-shark.off", 5246, 10192},
    {"ugly/cgal_mesh_with_colors.off", 12, 6},
    {"ugly/cgal_blobby-shuffled.off", 2027, 4050},
    {"ugly/cgal_sphere.stl", 162, 320},
    {"ugly/cgal_cube_poly.off", 8, 12},
    {"ugly/cgal_boeing.off", 2741, 2564},
    {"ugly/cgal_degtri_sliding.off", 8, 8},
    {"ugly/assimp_cube_uv.ply", 24, 12},
    {"ugly/assimp_cube_binary.ply", 8, 12},
    {"ugly/assimp_float-color.ply", 3, 1},
    {"ugly/assimp_Spider_binary.stl", 722, 1368},
    {"ugly/assimp_spider.obj", 902, 1368},
    {"ugly/assimp_WusonOBJ.obj", 2117, 3732},
    {"ugly/assimp_concave_polygon.obj", 64, 64},
    {"ugly/assimp_cube_with_vertexcolors.obj", 24, 12},
    {"ugly/assimp_box_longline.obj", 8, 944},
    {"ugly/assimp_box_without_lineending.obj", 8, 12},
    {"ugly/trimesh_featuretype.ply", 5096, 3476},
    {"ugly/trimesh_fuze.obj", 502, 1000},
    {"ugly/trimesh_fuze.ply", 502, 1000},
    {"ugly/trimesh_negative_indices.obj", 24, 12},
    {"ugly/trimesh_soup.stl", 300, 100},
    {"ugly/trimesh_joined_tetrahedra.obj", 15, 8},
    {"ugly/trimesh_cubevt.obj", 24, 12},
    {"ugly/trimesh_wallhole.obj", 92, 66},
    {"ugly/pymeshlab_bone.ply", 1872, 3022},
    {"ugly/vcglib_bunny10k_textured.ply", 5051, 9999},
    {"ugly/gc_moebius.obj", 280, 448},
    {"ugly/gc_hourglass_ico.obj", 120, 40},
    {"ugly/gc_fan3.obj", 5, 3},
    {"ugly/gc_stl_box_ascii.stl", 8, 12},
    {"ugly/happly_platonic_shelf.ply", 50, 80},
    {"ugly/happly_platonic_shelf_big_endian.ply", 50, 80},
    {"ugly/pmp_suzanne.obj", 1964, 968},
    {"ugly/c3d_teapot.obj", 3644, 6320},
    {"ugly/manifold_boxNotManifold.obj", 9, 12},
};

/// Counts of POSITION's accessors, and a third of the counts of the indices', summed over nodes and
/// instances.
constexpr RealMesh RealGltf[] = {
    {"draco/ambulance.gltf", 6222, 2588},
    {"draco/apple.gltf", 252, 136},
    {"draco/barrel.gltf", 484, 308},
    {"draco/bike.gltf", 372845, 276540},
    {"draco/boat-small.gltf", 260, 104},
    {"draco/bridge-01.gltf", 1716, 3198},
    {"draco/bunny.gltf", 29598, 58754},
    {"draco/burger.gltf", 524, 294},
    {"draco/cactus.gltf", 56861, 85590},
    {"draco/cannon-large.gltf", 2382, 1056},
    {"draco/chest.gltf", 1066, 452},
    {"draco/citroen-old-van.gltf", 8388, 4649},
    {"plain/ExplodingBarrel.glb", 4925, 8150},
    {"plain/TeapotsGalore/TeapotsGalore.gltf", 4185400, 7656770},
    {"plain/TextureTransform/TextureTransformTest.gltf", 48, 24},
    {"plain/cornellBox.glb", 2281, 4006},
    {"plain/runeSword.glb", 4295, 4296},
    {"plain/shaderBall.glb", 3074, 3392},
    {"plain/vintageDeskFan/vintageFan_animated.gltf", 15601, 21080},
    {"plain/webp/webp.gltf", 10584, 5292},
};

class RealDataTest : public testing::Test {
protected:
    void SetUp() override {
        if (real_data("meshes/stanford").empty())
            GTEST_SKIP() << absent_data("meshes/stanford");
    }
    const std::filesystem::path folder_ = real_data_folder() / "meshes";
};

TEST_F(RealDataTest, EveryMeshHasItsCounts) {
    for (const RealMesh& expected : RealMeshes) {
        SCOPED_TRACE(expected.path);
        const TriangleMesh mesh = load(folder_ / expected.path);
        EXPECT_EQ(mesh.num_vertices(), expected.num_vertices);
        EXPECT_EQ(mesh.num_triangles(), expected.num_triangles);
        EXPECT_EQ(defect(mesh), "");
    }
}

TEST(RealGltfTest, EveryAssetHasTheCountsOfItsAccessors) {
    const std::filesystem::path folder = real_data("gltf");
    if (folder.empty())
        GTEST_SKIP() << absent_data("gltf");
    for (const RealMesh& expected : RealGltf) {
        SCOPED_TRACE(expected.path);
        const TriangleMesh mesh = load(folder / expected.path);
        EXPECT_EQ(mesh.num_vertices(), expected.num_vertices);
        EXPECT_EQ(mesh.num_triangles(), expected.num_triangles);
        EXPECT_EQ(defect(mesh), "");
        EXPECT_THAT(mesh.missing, testing::IsEmpty());
    }
}

TEST_F(RealDataTest, ConcavePolygonIsCoveredExactly) {
    const TriangleMesh mesh = load(folder_ / "ugly/assimp_concave_polygon.obj");
    // Triangles that all look the same way cover no more than their sum's length, the polygon's own
    // area.
    glm::dvec3 sum(0.0);
    for (const Triangle& t : mesh.triangles)
        sum += 0.5 * glm::cross(glm::dvec3(mesh.positions[t[1]] - mesh.positions[t[0]]),
                                glm::dvec3(mesh.positions[t[2]] - mesh.positions[t[0]]));
    EXPECT_NEAR(area(mesh), glm::length(sum), 1e-4 * glm::length(sum));
}

TEST_F(RealDataTest, FloorGivesThePapersCounts) {
    const auto with_floor = [this](const char* name) {
        TriangleMesh mesh = load(folder_ / "stanford" / name);
        append_floor(mesh);
        return mesh.num_vertices();
    };
    EXPECT_EQ(with_floor("bun_zipper.ply"), 73196u);
    EXPECT_EQ(with_floor("dragon_vrip_res2.ply"), 137499u);
    EXPECT_EQ(with_floor("happy_vrip_res3.ply"), 69577u);
}

TEST_F(RealDataTest, MalformedFilesAreRefusedOrReadAsWhatTheyAre) {
    const std::vector<std::pair<std::string, std::size_t>> readable = {
        {"trimesh_nancolor.obj", 12},
        {"trimesh_notenoughindices.obj", 1},
        {"trimesh_obj_with_no_face_in_chunk.obj", 1}};
    std::size_t num_read = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "malformed")) {
        SCOPED_TRACE(entry.path());
        const std::clock_t start = std::clock(); // of the processor
        try {
            const TriangleMesh mesh = load(entry.path());
            EXPECT_THAT(readable, testing::Contains(testing::Pair(entry.path().filename().string(),
                                                                  mesh.num_triangles())));
            EXPECT_EQ(defect(mesh), "");
            if (!mesh.colors.empty()) { // some are not numbers
                EXPECT_THAT(mesh.warnings, testing::Contains(testing::HasSubstr("they are white")));
            }
            ++num_read;
        } catch (const std::runtime_error& error) {
            EXPECT_THAT(error.what(), testing::StartsWith(entry.path().string() + ": expected "));
        }
        EXPECT_LT(std::clock() - start, 10 * CLOCKS_PER_SEC);
    }
    EXPECT_EQ(num_read, readable.size());
}

} // namespace
} // namespace relumine::mesh
