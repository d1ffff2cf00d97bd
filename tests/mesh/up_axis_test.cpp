#include "mesh/up_axis.h"

#include <glm/geometric.hpp>

#include "tests/mesh/mesh_files.h"

namespace relumine::mesh {
namespace {

TEST(UpAxis, BecomesPlusY) {
    const auto turned = [](UpAxis axis, const glm::vec3& v) {
        TriangleMesh mesh;
        mesh.positions = mesh.normals = {v};
        turn_up(mesh, axis);
        EXPECT_EQ(mesh.positions, mesh.normals);
        return mesh.positions[0];
    };
    EXPECT_EQ(turned(UpAxis::Y, {1, 2, 3}), glm::vec3(1, 2, 3));
    EXPECT_EQ(turned(UpAxis::Z, {0, 0, 1}), glm::vec3(0, 1, 0));
    EXPECT_EQ(turned(UpAxis::X, {1, 0, 0}), glm::vec3(0, 1, 0));
    // What a CAD program calls the front, -Y, faces the camera.
    EXPECT_EQ(turned(UpAxis::Z, {0, -1, 0}), glm::vec3(0, 0, 1));
    // Turned, not mirrored.
    for (const UpAxis axis : {UpAxis::X, UpAxis::Y, UpAxis::Z})
        EXPECT_EQ(glm::cross(turned(axis, {1, 0, 0}), turned(axis, {0, 1, 0})),
                  turned(axis, {0, 0, 1}));
}

} // namespace
} // namespace relumine::mesh
