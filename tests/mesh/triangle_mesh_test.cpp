#include "tests/mesh/mesh_files.h"

namespace relumine::mesh {
namespace {

TEST(Bounds, StrayVerticesDoNotCount) {
    TriangleMesh mesh;
    EXPECT_EQ(bounds(mesh).diagonal(), 0.0f);
    mesh.positions = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 2, 2}};
    EXPECT_EQ(bounds(mesh).max, glm::vec3(9.0f)) << "no triangle: all vertices";
    mesh.triangles = {{1, 2, 3}};
    const Bounds box = bounds(mesh);
    EXPECT_EQ(box.min, glm::vec3(0.0f));
    EXPECT_EQ(box.max, glm::vec3(1, 2, 2));
    EXPECT_EQ(box.center(), glm::vec3(0.5f, 1.0f, 1.0f));
    EXPECT_EQ(box.diagonal(), 3.0f);
}

} // namespace
} // namespace relumine::mesh
