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
    const float height = mesh.positions[8].y;
    EXPECT_EQ(mesh.positions[8], glm::vec3(0.5f - 6.0f, height, 1.5f - 6.0f));
    EXPECT_EQ(mesh.positions.back(), glm::vec3(0.5f + 6.0f, height, 1.5f + 6.0f));
    EXPECT_EQ(mesh.normals.back(), glm::vec3(0, 1, 0));
    EXPECT_EQ(mesh.colors[0], glm::vec3(0, 0, 1));
    EXPECT_EQ(mesh.colors.back(), glm::vec3(1.0f));
    EXPECT_EQ(mesh.uvs.back(), glm::vec2(0.0f));
    const std::vector<glm::vec3> smooth = smooth_normals(mesh);
    for (std::size_t i = 8; i < mesh.num_vertices(); ++i)
        EXPECT_EQ(smooth[i], glm::vec3(0, 1, 0)) << "counter-clockwise seen from above";
}

TEST(Floor, LiesAHairBelowTheLowestPoint) {
    for (const float far_off : {0.0f, 1e6f}) {
        TriangleMesh mesh = box();
        for (glm::vec3& position : mesh.positions)
            position += glm::vec3(far_off);
        append_floor(mesh, 5);
        const float hair = mesh.positions[0].y - mesh.positions.back().y;
        // More than the lift of rays (prt::automatic_bias), and too little to be seen.
        EXPECT_GT(hair, 1.5e-4f * bounds(mesh).diagonal());
        EXPECT_LT(hair, far_off == 0.0f ? 0.01f : 1.1f);
        EXPECT_GT(hair, 4.0f * std::numeric_limits<float>::epsilon() * far_off);
    }
}

TEST(Floor, IsDenserUnderTheMesh) {
    TriangleMesh mesh = box();
    append_floor(mesh, 101, 4.0f);
    const FloorPlace place = floor_place(std::span(mesh.positions).subspan(8), 101);
    EXPECT_NEAR(place.center.x, 0.5f, 1e-5f);
    EXPECT_NEAR(place.center.y, 1.5f, 1e-5f);
    EXPECT_NEAR(place.half_side, 6.0f, 1e-5f);
    EXPECT_NEAR(place.spacing_inside, 0.4f * 0.12f, 2e-4f);
    EXPECT_NEAR(place.spacing_outside, 2.2f * 0.12f, 0.01f);
    for (std::size_t column = 0; column + 1 < 101; ++column)
        EXPECT_LT(mesh.positions[8 + column].x, mesh.positions[9 + column].x);
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
    EXPECT_EQ(mesh.positions.back().x, 1.0f);
    EXPECT_EQ(mesh.positions.back().z, 1.0f);
    EXPECT_TRUE(mesh.colors.empty());
}

TEST(Floor, UnderATallMeshTakesHalfTheHeight) {
    TriangleMesh mesh = box();
    const float width =
        std::max(bounds(mesh).max.x - bounds(mesh).min.x, bounds(mesh).max.z - bounds(mesh).min.z);
    for (glm::vec3& position : mesh.positions)
        position.y *= 10.0f;
    const float height = bounds(mesh).max.y - bounds(mesh).min.y;
    ASSERT_GT(height, 2.0f * width);
    append_floor(mesh, 2, 3.0f);
    EXPECT_NEAR(mesh.positions.back().x - mesh.positions[8].x, 1.5f * height, 1e-4f * height);
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

TEST(Floor, HasAGapBelowWhatStandsFlatOnIt) {
    TriangleMesh mesh = box();
    EXPECT_EQ(floor_gap(mesh, mesh.num_vertices()), 0.0f) << "there is no floor";
    append_floor(mesh, 5, 4.0f);
    const float gap = floor_gap(mesh, 8);
    EXPECT_GT(gap, 0.0f);
    const TriangleMesh raised = with_raised_floor(mesh, 8, gap);
    EXPECT_EQ(raised.triangles, mesh.triangles);
    EXPECT_NEAR(raised.positions[8].y, bounds(std::span(mesh.positions).first(8)).min.y, 1e-6f);
    EXPECT_EQ(raised.positions[0], mesh.positions[0]);
    // One that stands on a corner has none.
    for (std::size_t i = 0; i < 8; ++i)
        mesh.positions[i].y += 0.1f * (mesh.positions[i].x + mesh.positions[i].z);
    TriangleMesh on_floor;
    on_floor.positions.assign(mesh.positions.begin(), mesh.positions.begin() + 8);
    on_floor.triangles.assign(mesh.triangles.begin(), mesh.triangles.begin() + 12);
    on_floor.normals.assign(8, glm::vec3(0, 1, 0));
    append_floor(on_floor, 5, 4.0f);
    EXPECT_EQ(floor_gap(on_floor, 8), 0.0f);
}

} // namespace
} // namespace relumine::mesh
