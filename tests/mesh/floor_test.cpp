#include "mesh/floor.h"

#include <limits>

#include "mesh/normals.h"
#include "tests/mesh/mesh_files.h"

namespace relumine::mesh {
namespace {

TriangleMesh box() {
    TriangleMesh mesh =
        off("COFF\n8 7 0\n" + box_vertex_lines("", " 0 0 255 255") + box_face_lines());
    mesh.uvs.assign(8, {0.5f, 0.5f});
    return mesh;
}

TEST(Floor, AppendsAGridUnderTheMesh) {
    TriangleMesh mesh = box();
    const TriangleMesh before = mesh;
    append_floor(mesh, 5, 4.0f);
    EXPECT_EQ(defect(mesh), "");
    ASSERT_EQ(mesh.num_vertices(), 8u + 25u);
    ASSERT_EQ(mesh.num_triangles(), 12u + 32u);
    EXPECT_TRUE(
        std::equal(before.positions.begin(), before.positions.end(), mesh.positions.begin()));
    EXPECT_TRUE(
        std::equal(before.triangles.begin(), before.triangles.end(), mesh.triangles.begin()));
    EXPECT_NEAR(area(mesh) - BoxArea, 144.0, 1e-4) << "four times the larger extent, 3, squared";
    EXPECT_EQ(mesh.positions[8], glm::vec3(0.5f - 6.0f, 0.0f, 1.5f - 6.0f));
    EXPECT_EQ(mesh.positions.back(), glm::vec3(0.5f + 6.0f, 0.0f, 1.5f + 6.0f));
    EXPECT_EQ(mesh.normals.back(), glm::vec3(0, 1, 0));
    EXPECT_EQ(mesh.colors[0], glm::vec3(0, 0, 1));
    EXPECT_EQ(mesh.colors.back(), glm::vec3(1.0f));
    EXPECT_EQ(mesh.uvs.back(), glm::vec2(0.0f));
    const std::vector<glm::vec3> smooth = smooth_normals(mesh);
    for (std::size_t i = 8; i < mesh.num_vertices(); ++i)
        EXPECT_EQ(smooth[i], glm::vec3(0, 1, 0)) << "counter-clockwise seen from above";
}

TEST(Floor, OfTheSizeOfThePaper) {
    TriangleMesh mesh = box();
    append_floor(mesh);
    EXPECT_EQ(mesh.num_vertices(), 8u + 37249u);
    EXPECT_EQ(mesh.num_triangles(), 12u + 2u * 192u * 192u);
    EXPECT_EQ(defect(mesh), "");
}

TEST(Floor, UnderAnUprightMeshTakesTheDiagonal) {
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {0, 2, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    append_floor(mesh, 2, 1.0f);
    EXPECT_EQ(mesh.positions.back(), glm::vec3(1, 0, 1));
    EXPECT_TRUE(mesh.colors.empty());
}

TEST(Floor, RefusesWhatIsNoFloor) {
    TriangleMesh mesh = box();
    for (const std::uint32_t n : {0u, 1u, 65536u, 4294967295u})
        EXPECT_THROW(append_floor(mesh, n), std::invalid_argument) << n;
    for (const float scale : {0.0f, -1.0f, std::numeric_limits<float>::infinity(), std::nanf("")})
        EXPECT_THROW(append_floor(mesh, 2, scale), std::invalid_argument) << scale;
    EXPECT_EQ(mesh.num_vertices(), 8u);
    TriangleMesh empty;
    EXPECT_THROW(append_floor(empty), std::invalid_argument);
}

} // namespace
} // namespace relumine::mesh
