#include "prt/receivers/lit_position.h"

#include <cmath>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

/// A wall of one square whose normals pretend that it bulges by a quarter of its side, and a beam
/// close before it.
TEST(LitPosition, IsInFrontOfNothing) {
    mesh::TriangleMesh wall = scenes::floor_grid(2, 2.0f);
    for (std::size_t i = 0; i < 4; ++i)
        wall.normals[i] = glm::normalize(glm::vec3(0.7f, 1.0f, 0.7f) *
                                         (glm::sign(wall.positions[i]) + glm::vec3(0, 1, 0)));
    const mesh::TriangleMesh beam = scenes::box({-2, 0.05f, -0.5f}, {2, 0.15f, 0.5f});
    const mesh::TriangleMesh mesh = scenes::joined(wall, beam);
    const RayScene rays(mesh), alone(wall);
    constexpr float Bias = 1e-4f;
    const MeshPoint below{.triangle = 0, .barycentric = {0.25f, 0.25f}};
    const glm::vec3 own = value_at(mesh, mesh.positions, below), up(0, 1, 0);
    const glm::vec3 smooth = smooth_position(mesh, below);
    ASSERT_GT(smooth.y, 0.05f) << "inside of the beam or above it";
    ASSERT_LT(std::abs(smooth.z), 0.4f);
    EXPECT_EQ(lit_position(mesh, rays, below, up, Bias), own);
    EXPECT_EQ(lit_position(wall, alone, below, up, Bias), smooth);

    // Of receivers on the smooth surface only the one below the beam goes back.
    const MeshPoint beside{.triangle = 0, .barycentric = {0.05f, 0.05f}};
    Receivers receivers{.positions = {smooth, smooth_position(mesh, beside), own},
                        .normals = {up, up, up},
                        .points = {below, beside, below}};
    const std::vector<glm::vec3> expected = {own, receivers.positions[1], own};
    ASSERT_GT(expected[1].y, Bias);
    leave_obstacles(mesh, rays, Bias, receivers);
    EXPECT_EQ(receivers.positions, expected);
}

} // namespace
} // namespace relumine::prt
