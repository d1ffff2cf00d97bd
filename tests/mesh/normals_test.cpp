#include "mesh/normals.h"

#include <numbers>

#include "tests/mesh/mesh_files.h"

namespace relumine::mesh {
namespace {

TEST(SmoothNormals, CubeCornersPointAlongTheDiagonalsHoweverQuadsAreCut) {
    // Each of the 64 ways to cut the six quads.
    const std::vector<std::array<std::uint32_t, 4>> quads = {
        {0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    for (unsigned cut = 0; cut < 64; ++cut) {
        TriangleMesh mesh;
        for (const glm::vec3& corner : BoxPositions)
            mesh.positions.push_back(glm::sign(corner - glm::vec3(0.5f)));
        for (std::size_t i = 0; i < quads.size(); ++i) {
            const auto& q = quads[i];
            const std::size_t s = (cut >> i) & 1;
            mesh.triangles.push_back({q[s], q[s + 1], q[s + 2]});
            mesh.triangles.push_back({q[s], q[s + 2], q[(s + 3) % 4]});
        }
        const std::vector<glm::vec3> normals = smooth_normals(mesh);
        for (std::size_t i = 0; i < 8; ++i)
            EXPECT_NEAR(glm::distance(normals[i], mesh.positions[i] / std::sqrt(3.0f)), 0.0f, 1e-6f)
                << cut;
    }
}

TEST(SmoothNormals, SphereIsNearlyRadial) {
    constexpr std::uint32_t N = 64;
    constexpr std::size_t RowLength = std::size_t{2} * N;
    TriangleMesh mesh;
    for (std::uint32_t row = 0; row <= N; ++row)
        for (std::uint32_t column = 0; column < 2 * N; ++column) {
            const double theta = std::numbers::pi * row / N, phi = std::numbers::pi * column / N;
            mesh.positions.emplace_back(std::sin(theta) * std::sin(phi), std::cos(theta),
                                        std::sin(theta) * std::cos(phi));
        }
    for (std::uint32_t row = 0; row < N; ++row)
        for (std::uint32_t column = 0; column < 2 * N; ++column) {
            const std::uint32_t right = (column + 1) % (2 * N);
            const std::uint32_t a = row * 2 * N + column, b = row * 2 * N + right, c = a + 2 * N,
                                d = b + 2 * N;
            mesh.triangles.push_back({a, c, b});
            mesh.triangles.push_back({b, c, d});
        }
    const std::vector<glm::vec3> normals = smooth_normals(mesh);
    for (std::size_t i = RowLength; i < mesh.num_vertices() - RowLength; ++i)
        EXPECT_GT(glm::dot(normals[i], mesh.positions[i]), 0.9999f);
}

TEST(SmoothNormals, ZeroWithoutAnAreaAndIndependentOfScale) {
    TriangleMesh mesh;
    for (const float scale : {1e-30f, 1e-10f, 1.0f, 1e18f}) {
        mesh.positions = {{0, 0, 0}, {scale, 0, 0}, {0, 0, -scale}, {2 * scale, 0, 0}, {9, 9, 9}};
        mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {3, 3, 1}};
        const std::vector<glm::vec3> normals = smooth_normals(mesh);
        EXPECT_EQ(normals[0], glm::vec3(0, 1, 0)) << scale;
        EXPECT_EQ(normals[3], glm::vec3(0.0f)) << "only faces without area";
        EXPECT_EQ(normals[4], glm::vec3(0.0f)) << "no face";
    }
}

} // namespace
} // namespace relumine::mesh
