#include "prt/receivers/lit_position.h"

#include <algorithm>
#include <cmath>
#include <utility>
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

/// A square of side 2 in the plane y = 0, of two triangles that share no vertex with others.
mesh::TriangleMesh sheet(bool faces_up) {
    mesh::TriangleMesh mesh = scenes::floor_grid(2, 2.0f);
    if (!faces_up)
        for (auto& [a, b, c] : mesh.triangles)
            std::swap(b, c);
    for (glm::vec3& normal : mesh.normals)
        normal.y = faces_up ? 1.0f : -1.0f;
    return mesh;
}

/// A crate of side 1 whose faces share no vertices, with its bottom at a height.
mesh::TriangleMesh crate(float height) {
    mesh::TriangleMesh mesh;
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {-1.0f, 1.0f}) {
            const auto first = static_cast<std::uint32_t>(mesh.num_vertices());
            for (const auto& [u, v] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
                glm::vec3 at(0.0f), normal(0.0f);
                at[axis] = normal[axis] = side;
                at[(axis + 1) % 3] = static_cast<float>(u) * side;
                at[(axis + 2) % 3] = static_cast<float>(v);
                mesh.positions.push_back(0.5f * at + glm::vec3(0, 0.5f + height, 0));
                mesh.normals.push_back(normal);
            }
            mesh.triangles.push_back({first, first + 1, first + 2});
            mesh.triangles.push_back({first, first + 2, first + 3});
        }
    return mesh;
}

/// Whether the ray that starts at a position leaves the mesh downwards.
bool sees_below(const RayScene& rays, const glm::vec3& position, const glm::vec3& normal) {
    return !rays.occluded(ray_origin(position, normal, 1e-3f), {0.1f, -1.0f, 0.05f});
}

TEST(LitPosition, VerticesThatTouchASheetDoNotLookFromBeyondIt) {
    constexpr float Bias = 1e-3f;
    for (const float height : {0.0f, 0.3f * Bias, -1e-8f}) {
        mesh::TriangleMesh mesh = scenes::joined(sheet(true), crate(height));
        const RayScene rays(mesh);
        std::size_t num_bottom = 0;
        const Receivers before = vertex_receivers(mesh);
        leave_obstacles(rays, Bias, mesh);
        const Receivers after = vertex_receivers(mesh);
        for (std::size_t i = 0; i < mesh.num_vertices(); ++i) {
            if (mesh.normals[i].y > -0.5f) {
                EXPECT_EQ(after.positions[i], before.positions[i]) << i;
                continue;
            }
            ++num_bottom;
            EXPECT_TRUE(sees_below(rays, before.positions[i], mesh.normals[i])) << height;
            EXPECT_FALSE(sees_below(rays, after.positions[i], mesh.normals[i])) << height;
        }
        EXPECT_EQ(num_bottom, 4u);
    }
}

TEST(LitPosition, VerticesThatTouchNothingStay) {
    // Farther than the bias; faces of one plane that face alike; both sides of a sheet.
    mesh::TriangleMesh other_diagonal = sheet(false);
    other_diagonal.triangles = {{0, 1, 2}, {1, 3, 2}};
    for (mesh::TriangleMesh mesh :
         {scenes::joined(sheet(true), other_diagonal), scenes::joined(sheet(true), crate(2e-3f)),
          scenes::joined(sheet(true), sheet(true)), scenes::joined(sheet(true), sheet(false)),
          scenes::icosphere(3, 1.0f, {0, 0, 0})}) {
        const RayScene rays(mesh);
        leave_obstacles(rays, 1e-3f, mesh);
        EXPECT_TRUE(mesh.lifts.empty());
    }
}

TEST(LitPosition, RefinedVerticesOfASheetWithTwoSidesStay) {
    // Rays meet the sheet as it was, cut along another diagonal on each side.
    mesh::TriangleMesh below = sheet(false);
    below.triangles = {{0, 1, 2}, {1, 3, 2}};
    const RayScene rays(scenes::joined(sheet(true), below));
    mesh::TriangleMesh fine = scenes::floor_grid(6, 2.0f);
    leave_obstacles(rays, 1e-3f, fine);
    EXPECT_TRUE(fine.lifts.empty());
}

TEST(LitPosition, ABallOnASheetIsDarkAtTheContact) {
    constexpr float Bias = 1e-3f;
    const mesh::TriangleMesh ball = scenes::icosphere(4, 1.0f, {0, 1, 0});
    mesh::TriangleMesh mesh = scenes::joined(sheet(true), ball);
    // The lowest vertex touches the sheet.
    float lowest = 1.0f;
    for (const glm::vec3& at : ball.positions)
        lowest = std::min(lowest, at.y);
    for (std::size_t i = 4; i < mesh.num_vertices(); ++i)
        mesh.positions[i].y -= lowest;
    const RayScene rays(mesh);
    leave_obstacles(rays, Bias, mesh);
    ASSERT_EQ(mesh.lifts.size(), mesh.num_vertices());
    const Receivers receivers = vertex_receivers(mesh);
    std::size_t num_moved = 0;
    for (std::size_t i = 4; i < mesh.num_vertices(); ++i) {
        EXPECT_FALSE(std::abs(mesh.positions[i].x) < 0.5f && std::abs(mesh.positions[i].z) < 0.5f &&
                     mesh.positions[i].y < 0.5f &&
                     sees_below(rays, receivers.positions[i], mesh.normals[i]));
        num_moved += mesh.lifts[i] != glm::vec3(0.0f) ? 1 : 0;
    }
    EXPECT_GE(num_moved, 1u);
    EXPECT_LE(num_moved, 9u);
}

TEST(LitPosition, PointsOnTheRimOfASurfaceStandInside) {
    // A wall stands on the rim of the sheet. A point on the rim itself lies in the wall's plane.
    mesh::TriangleMesh mesh = sheet(true);
    mesh.positions.insert(mesh.positions.end(), {{-1, 0, -1}, {1, 0, -1}, {1, 2, -1}, {-1, 2, -1}});
    mesh.normals.resize(8, {0, 0, 1});
    mesh.triangles.push_back({4, 5, 6});
    mesh.triangles.push_back({4, 6, 7});
    const RayScene rays(mesh);
    constexpr float Bias = 1e-3f;
    Receivers receivers;
    for (std::uint32_t triangle = 0; triangle < 2; ++triangle)
        for (const glm::vec2& at :
             {glm::vec2(0.5f, 0.0f), glm::vec2(0.0f, 0.5f), glm::vec2(0.5f, 0.5f), glm::vec2(0.0f),
              glm::vec2(1.0f, 0.0f), glm::vec2(0.0f, 1.0f), glm::vec2(0.3f)})
            receivers.points.push_back({triangle, at});
    for (const MeshPoint& point : receivers.points) {
        receivers.positions.push_back(value_at(mesh, mesh.positions, point));
        receivers.normals.emplace_back(0, 1, 0);
    }
    const std::vector<glm::vec3> before = receivers.positions;
    leave_obstacles(mesh, rays, Bias, receivers);
    for (std::size_t i = 0; i < before.size(); ++i) {
        const glm::vec3& at = receivers.positions[i];
        const bool is_on_rim = std::max(std::abs(before[i].x), std::abs(before[i].z)) == 1.0f;
        if (!is_on_rim) { // also where the two triangles meet
            EXPECT_EQ(at, before[i]) << i;
        }
        EXPECT_LE(std::max(std::abs(at.x), std::abs(at.z)), is_on_rim ? 1.0f - 0.9f * Bias : 1.0f)
            << i << ": " << before[i].x << " " << before[i].z << " " << at.x << " " << at.z;
        EXPECT_LT(glm::distance(at, before[i]), 4.0f * Bias);
        EXPECT_EQ(at.y, 0.0f);
        // The wall hides what is behind it.
        EXPECT_TRUE(rays.occluded(ray_origin(at, {0, 1, 0}, Bias), {0.0f, 0.01f, -1.0f})) << i;
    }
}

} // namespace
} // namespace relumine::prt
