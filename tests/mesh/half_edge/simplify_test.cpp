#include "mesh/half_edge/simplify.h"

#include <set>

#include "tests/mesh/half_edge/shapes.h"

namespace relumine::mesh {
namespace {

using Place = std::array<float, 3>;

std::set<Place> places(const TriangleMesh& mesh) {
    std::set<Place> result;
    for (const glm::vec3& p : mesh.positions)
        result.insert({p.x, p.y, p.z});
    return result;
}

std::set<std::pair<Place, Place>> rim(const TriangleMesh& mesh) {
    std::set<std::pair<Place, Place>> result;
    for_each_edge(edge_uses(mesh.triangles), [&](std::span<const EdgeUse> edge) {
        const glm::vec3 &a = mesh.positions[edge[0].low], &b = mesh.positions[edge[0].high];
        if (edge.size() == 1)
            result.insert(std::minmax(Place{a.x, a.y, a.z}, Place{b.x, b.y, b.z}));
    });
    return result;
}

TEST(Simplify, ABallKeepsItsShape) {
    const TriangleMesh mesh = ball(24);
    const TriangleMesh coarse = simplified(mesh, mesh.num_vertices() / 4);
    EXPECT_EQ(coarse.num_vertices(), mesh.num_vertices() / 4);
    EXPECT_EQ(edge_counts(coarse.triangles)[0], 0u) << "closed";
    EXPECT_NEAR(volume(coarse), volume(mesh), 0.05 * volume(mesh));
    const std::set<Place> old = places(mesh);
    for (std::size_t i = 0; i < coarse.num_vertices(); ++i) {
        const glm::vec3& p = coarse.positions[i];
        EXPECT_EQ(old.count({p.x, p.y, p.z}), 1u) << "a vertex of the mesh";
        EXPECT_GT(glm::dot(coarse.normals[i], p), 0.99f) << "with its normal";
    }
}

TEST(Simplify, BordersStay) {
    const TriangleMesh mesh = sheet(12);
    const TriangleMesh coarse = simplified(mesh, 60);
    EXPECT_LE(coarse.num_vertices(), 60u);
    EXPECT_EQ(rim(coarse), rim(mesh));
    EXPECT_NEAR(area(coarse), 1.0, 1e-6);
    // No more than the rim can remain.
    EXPECT_EQ(simplified(mesh, 4).num_vertices(), 44u);
}

TEST(Simplify, SeamsAndMaterialsKeepTheirPlaces) {
    TriangleMesh mesh = sheet(9);
    mesh.materials = {{.name = "a"}, {.name = "b"}};
    for (const Triangle& t : mesh.triangles) {
        const float x =
            (mesh.positions[t[0]].x + mesh.positions[t[1]].x + mesh.positions[t[2]].x) / 3.0f;
        mesh.triangle_materials.push_back(x < 0.5f ? 0 : 1);
        const float shift = x < 0.5f ? 0.0f : 3.0f;
        std::array<glm::vec2, 3> uvs{};
        for (std::size_t k = 0; k < 3; ++k)
            uvs[k] = {mesh.positions[t[k]].x + shift, mesh.positions[t[k]].z};
        mesh.corner_uvs.push_back(uvs);
    }
    const TriangleMesh coarse = simplified(mesh, 45);
    EXPECT_LE(coarse.num_vertices(), 45u);
    std::array<double, 2> areas{};
    for (std::size_t i = 0; i < coarse.num_triangles(); ++i) {
        const std::uint32_t material = coarse.triangle_materials[i];
        areas[material] += 0.5 * glm::length(area_normal(coarse.positions, coarse.triangles[i]));
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::vec3& p = coarse.positions[coarse.triangles[i][k]];
            EXPECT_EQ(coarse.corner_uvs[i][k], glm::vec2(p.x + (material == 0 ? 0.0f : 3.0f), p.z));
        }
    }
    EXPECT_NEAR(areas[0], 0.5, 1e-6);
    EXPECT_NEAR(areas[1], 0.5, 1e-6);
}

TEST(Simplify, TooFewAreRefused) {
    EXPECT_THROW(static_cast<void>(simplified(ball(4), 3)), std::invalid_argument);
    EXPECT_EQ(simplified(ball(4), 1000).triangles, ball(4).triangles);
}

} // namespace
} // namespace relumine::mesh
