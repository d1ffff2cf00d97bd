#include "prt/receivers/mesh_point.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/prt/scenes.h"
#include "tests/prt/textured_square.h"

namespace relumine::prt {
namespace {

TEST(RandomPoints, AreEvenByArea) {
    // Two triangles, one with three times the area of the other.
    mesh::TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {5, 0, 0}, {5, 0, 3}, {6, 0, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 0, 1}, {3, 4, 5}};
    const std::vector<MeshPoint> points = random_points(mesh, 40000, 7);
    ASSERT_EQ(points.size(), 40000u);
    double num_small = 0.0;
    glm::dvec2 mean(0.0);
    for (const MeshPoint& point : points) {
        EXPECT_NE(point.triangle, 1u) << "without an area";
        EXPECT_GE(point.barycentric.x, 0.0f);
        EXPECT_GE(point.barycentric.y, 0.0f);
        EXPECT_LE(point.barycentric.x + point.barycentric.y, 1.0f + 1e-6f);
        num_small += point.triangle == 0 ? 1.0 : 0.0;
        mean += glm::dvec2(point.barycentric) / 40000.0;
    }
    EXPECT_NEAR(num_small / 40000.0, 0.25, 0.01);
    EXPECT_NEAR(mean.x, 1.0 / 3.0, 0.005);
    EXPECT_NEAR(mean.y, 1.0 / 3.0, 0.005);
    EXPECT_EQ(random_points(mesh, 100, 7), random_points(mesh, 100, 7));
    EXPECT_NE(random_points(mesh, 100, 7), random_points(mesh, 100, 8));
    mesh.triangles = {{0, 0, 1}};
    EXPECT_TRUE(random_points(mesh, 10, 1).empty());
}

TEST(MappedNormal, IsTheVectorOfTheMapInTheFrameOfTheUvs) {
    const mesh::TriangleMesh flat = scenes::mapped_square({127, 128, 255});
    const MeshPoint at{.triangle = 1, .barycentric = {0.25f, 0.5f}};
    EXPECT_EQ(mapped_normal(flat, at), glm::vec3(0, 0, 1)) << "bit by bit";
    // Bytes of 255, 128 and 1 are 1, 0 and -1.
    mesh::TriangleMesh tilted = scenes::mapped_square({255, 128, 255});
    EXPECT_LT(glm::distance(mapped_normal(tilted, at), glm::normalize(glm::vec3(1, 0, 1))), 1e-6f);
    tilted.materials[0].normal_scale = 0.5f;
    EXPECT_LT(glm::distance(mapped_normal(tilted, at), glm::normalize(glm::vec3(0.5f, 0, 1))),
              1e-6f);
    const mesh::TriangleMesh down = scenes::mapped_square({128, 0, 255});
    EXPECT_LT(glm::distance(mapped_normal(down, at), glm::normalize(glm::vec3(0, -1, 1))), 1e-6f);
    // Without a map.
    tilted.materials[0].normal_texture.reset();
    EXPECT_EQ(mapped_normal(tilted, at), glm::vec3(0, 0, 1));
}

} // namespace
} // namespace relumine::prt
