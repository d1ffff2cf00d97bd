#include "prt/receivers/receivers.h"

#include <gtest/gtest.h>

#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

TEST(Receivers, OnePerVertexInTheMeshsOrder) {
    const mesh::TriangleMesh mesh = scenes::icosphere(1, 2.0f, {1, 2, 3});
    const Receivers receivers = vertex_receivers(mesh);
    EXPECT_EQ(receivers.positions, mesh.positions);
    EXPECT_EQ(receivers.normals, mesh.normals);
}

} // namespace
} // namespace relumine::prt
