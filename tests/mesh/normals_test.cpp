#include "mesh/normals.h"

#include <numbers>

#include "tests/mesh/half_edge/shapes.h"

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

TEST(Creases, ACubeGetsFlatFacesAndASphereNothing) {
    const TriangleMesh cube = with_creases(box_mesh(), 40.0f);
    EXPECT_EQ(cube.num_vertices(), 24u);
    EXPECT_EQ(std::vector(cube.positions.begin(), cube.positions.begin() + 8), BoxPositions);
    for (const Triangle& t : cube.triangles) {
        const glm::vec3 flat(glm::normalize(area_normal(cube.positions, t)));
        for (const std::uint32_t vertex : t)
            EXPECT_NEAR(glm::distance(cube.normals[vertex], flat), 0.0f, 1e-6f);
    }
    const TriangleMesh sphere = ball(16);
    const TriangleMesh same = with_creases(sphere, 40.0f);
    EXPECT_EQ(same.triangles, sphere.triangles);
    EXPECT_EQ(same.positions, sphere.positions);
    for (std::size_t i = 0; i < sphere.num_vertices(); ++i)
        EXPECT_NEAR(glm::distance(same.normals[i], sphere.normals[i]), 0.0f, 1e-6f);
    EXPECT_EQ(with_creases(box_mesh(), 90.0f).num_vertices(), 8u) << "90 degrees are within 90";
    EXPECT_EQ(with_creases(box_mesh(), 89.0f).num_vertices(), 24u);
}

TEST(Creases, VerticesAtOnePlaceAreSmoothAcrossTheirSeam) {
    // The cube of 24 vertices becomes smooth again, and keeps its vertices.
    TriangleMesh flat = with_creases(box_mesh(), 40.0f);
    for (std::size_t i = 0; i < flat.num_vertices(); ++i)
        flat.uvs.emplace_back(static_cast<float>(i), 0.0f);
    const TriangleMesh smooth = with_creases(flat, 100.0f);
    EXPECT_EQ(smooth.triangles, flat.triangles);
    EXPECT_EQ(smooth.uvs, flat.uvs);
    for (std::size_t i = 0; i < 8; ++i)
        EXPECT_NEAR(glm::distance(smooth.normals[i], box_mesh().normals[i]), 0.0f, 1e-6f);
}

TEST(Creases, OnlyTheVerticesOfTheEdgeAreDoubled) {
    // A roof: two slopes of 3 x 3 vertices that meet at a ridge of 90 degrees.
    TriangleMesh roof;
    for (int x = -2; x <= 2; ++x)
        for (int z = 0; z < 3; ++z)
            roof.positions.emplace_back(x, -std::abs(x), z);
    for (std::uint32_t x = 0; x < 4; ++x)
        for (std::uint32_t z = 0; z < 2; ++z) {
            const std::uint32_t a = 3 * x + z;
            roof.triangles.push_back({a, a + 1, a + 3});
            roof.triangles.push_back({a + 1, a + 4, a + 3});
        }
    roof.normals = smooth_normals(roof);
    roof.colors.assign(15, glm::vec3(0.5f));
    const TriangleMesh creased = with_creases(roof, 40.0f);
    EXPECT_EQ(creased.num_vertices(), 18u);
    EXPECT_EQ(creased.colors.size(), 18u);
    for (const glm::vec3& normal : creased.normals)
        EXPECT_NEAR(std::abs(normal.x), std::sqrt(0.5f), 1e-6f);
}

TEST(Normals, OfTrianglesWithVerticesThatAreNotThereAreRefused) {
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3'000'000'000}};
    EXPECT_THROW(static_cast<void>(smooth_normals(mesh)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(with_creases(mesh, 30.0f)), std::invalid_argument);
}

} // namespace
} // namespace relumine::mesh
