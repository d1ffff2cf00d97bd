#include "mesh/half_edge/split_mesh.h"

#include <limits>
#include <map>

#include "mesh/half_edge/curved_surface.h"
#include "tests/mesh/half_edge/shapes.h"

namespace relumine::mesh {
namespace {

constexpr std::size_t NoLimit = std::numeric_limits<std::size_t>::max();

/// Splits edges that a hash of their number chooses, for some rounds.
TriangleMesh split_here_and_there(const TriangleMesh& mesh, int rounds) {
    SplitMesh split(mesh);
    for (int round = 0; round < rounds; ++round) {
        const auto num_edges = static_cast<std::uint32_t>(split.num_edges());
        for (std::uint32_t edge = 0; edge < num_edges; ++edge)
            if (!split.is_split(edge) && split.length(edge) > 0.0f &&
                edge * 2654435761u >> 29u == 0) {
                EXPECT_TRUE(split.mark(edge, NoLimit));
            }
        const std::size_t expected = split.mesh().num_vertices() + split.num_marked();
        split.split();
        EXPECT_EQ(split.mesh().num_vertices(), expected);
    }
    return split.take();
}

TEST(SplitMesh, KeepsOldVerticesAreaVolumeAndEdges) {
    for (const TriangleMesh& mesh : {box_mesh(), sheet(4), ball(6)}) {
        const TriangleMesh fine = split_here_and_there(mesh, 5);
        ASSERT_GT(fine.num_vertices(), 2 * mesh.num_vertices());
        for (std::size_t i = 0; i < mesh.num_vertices(); ++i) {
            EXPECT_EQ(fine.positions[i], mesh.positions[i]);
            EXPECT_EQ(fine.normals[i], mesh.normals[i]);
        }
        EXPECT_NEAR(area(fine), area(mesh), 1e-6 * area(mesh));
        EXPECT_NEAR(volume(fine), volume(mesh), 1e-6 * area(mesh));
        // Each edge has one triangle or two, a rim stays as long and a closed mesh closed.
        const auto [rim, inner, more] = edge_counts(fine.triangles);
        EXPECT_EQ(more, 0u);
        EXPECT_EQ(rim == 0, edge_counts(mesh.triangles)[0] == 0);
        double length = 0.0, length_before = 0.0;
        const auto add = [](const TriangleMesh& of, double& sum) {
            for_each_edge(edge_uses(of.triangles), [&](std::span<const EdgeUse> edge) {
                if (edge.size() == 1)
                    sum += glm::distance(of.positions[edge[0].low], of.positions[edge[0].high]);
            });
        };
        add(fine, length);
        add(mesh, length_before);
        EXPECT_NEAR(length, length_before, 1e-5) << "of the rim";
        // Euler's number.
        const auto euler = [](const TriangleMesh& of) {
            const auto counts = edge_counts(of.triangles);
            return static_cast<std::ptrdiff_t>(of.num_vertices() + of.num_triangles()) -
                   static_cast<std::ptrdiff_t>(counts[0] + counts[1]);
        };
        EXPECT_EQ(euler(fine), euler(mesh));
    }
}

TEST(SplitMesh, NoAngleGetsEverSmaller) {
    const auto smallest = [](const TriangleMesh& mesh) {
        double least = 4.0;
        for (const Triangle& t : mesh.triangles)
            for (std::size_t k = 0; k < 3; ++k) {
                const glm::dvec3 a(mesh.positions[t[k]]), b(mesh.positions[t[(k + 1) % 3]]),
                    c(mesh.positions[t[(k + 2) % 3]]);
                least = std::min(least,
                                 std::acos(glm::dot(glm::normalize(b - a), glm::normalize(c - a))));
            }
        return least;
    };
    for (const TriangleMesh& mesh : {box_mesh(), sheet(3), ball(5)})
        EXPECT_GT(smallest(split_here_and_there(mesh, 12)), 0.49 * smallest(mesh));
}

TEST(SplitMesh, AttributesStayOnTheirSideOfASeam) {
    // Two squares that meet at a seam: the left has u of 0 to 1, the right of 5 to 6.
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1},
                      {1, 0, 0}, {2, 0, 0}, {1, 0, 1}, {2, 0, 1}};
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 6, 5}, {5, 6, 7}};
    mesh.uvs = {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {5, 0}, {6, 0}, {5, 1}, {6, 1}};
    mesh.colors.assign(8, glm::vec3(0.25f));
    mesh.colors[7] = glm::vec3(0.75f);
    mesh.materials = {{.name = "left"}, {.name = "right"}};
    mesh.triangle_materials = {0, 0, 1, 1};
    mesh = with_normals(mesh);
    const TriangleMesh fine = split_here_and_there(mesh, 6);
    std::map<std::pair<float, float>, std::vector<float>> at_seam;
    for (std::size_t i = 0; i < fine.num_triangles(); ++i)
        for (const std::uint32_t v : fine.triangles[i]) {
            const bool is_right = fine.triangle_materials[i] == 1;
            EXPECT_FLOAT_EQ(fine.uvs[v].x, fine.positions[v].x + (is_right ? 4.0f : 0.0f));
            EXPECT_FLOAT_EQ(fine.uvs[v].y, fine.positions[v].z);
            EXPECT_GE(fine.colors[v].r, 0.25f);
            EXPECT_LE(fine.colors[v].r, 0.75f);
        }
    // Both sides of the seam have the same places.
    std::map<float, int> places;
    for (std::size_t v = 0; v < fine.num_vertices(); ++v)
        if (fine.positions[v].x == 1.0f)
            ++places[fine.positions[v].z];
    EXPECT_GT(places.size(), 2u);
    for (const auto& [z, count] : places)
        EXPECT_EQ(count, 2) << "a gap at the seam, z = " << z;
}

TEST(SplitMesh, UvsOfCornersAreInterpolatedInTheirTriangle) {
    TriangleMesh mesh = box_mesh();
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
        const auto base = static_cast<float>(10 * i);
        mesh.corner_uvs.push_back({glm::vec2(base, 0), glm::vec2(base + 1, 0), glm::vec2(base, 1)});
        mesh.triangle_groups.push_back(static_cast<std::uint32_t>(i));
    }
    SplitMesh split(mesh);
    for (int round = 0; round < 4; ++round) {
        for (std::uint32_t edge = 0; edge < split.num_edges(); edge += 3)
            if (!split.is_split(edge))
                static_cast<void>(split.mark(edge, NoLimit));
        split.split();
    }
    const TriangleMesh& fine = split.mesh();
    for (std::uint32_t i = 0; i < fine.num_triangles(); ++i) {
        const std::uint32_t from = fine.triangle_groups[i];
        EXPECT_EQ(split.origin(i).triangle, from);
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::vec2 at =
                fine.corner_uvs[i][k] - glm::vec2(10.0f * static_cast<float>(from), 0);
            EXPECT_EQ(split.origin(i).corners[k], at);
            const Triangle& t = mesh.triangles[from];
            const glm::vec3 expected = (1.0f - at.x - at.y) * mesh.positions[t[0]] +
                                       at.x * mesh.positions[t[1]] + at.y * mesh.positions[t[2]];
            EXPECT_NEAR(glm::distance(fine.positions[fine.triangles[i][k]], expected), 0.0f, 1e-5f);
        }
    }
}

TEST(SplitMesh, ALimitMarksNothingHalfWay) {
    SplitMesh split(ball(6));
    std::size_t room = 10;
    for (std::uint32_t edge = 0; edge < split.num_edges(); ++edge) {
        const std::size_t before = split.num_marked();
        if (!split.mark(edge, room)) {
            EXPECT_EQ(split.num_marked(), before);
        }
        EXPECT_LE(split.num_marked(), room);
    }
    const std::size_t marked = split.num_marked(), before = split.mesh().num_vertices();
    EXPECT_GT(marked, 5u);
    split.split();
    EXPECT_EQ(split.mesh().num_vertices(), before + marked);
    EXPECT_EQ(edge_counts(split.mesh().triangles)[0], 0u);
}

TEST(SplitMesh, TrianglesWithoutAreaAndEdgesOfThreeTriangles) {
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 1}, {-1, 0, -1}, {0, 0.5f, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}, {0, 5, 1}, {2, 2, 3}, {1, 1, 1}};
    mesh = with_normals(mesh);
    const TriangleMesh fine = split_here_and_there(mesh, 6);
    EXPECT_NEAR(area(fine), area(mesh), 1e-6);
}

TEST(CurvedSurface, ABallGetsRounder) {
    const TriangleMesh coarse = [] {
        TriangleMesh mesh = ball(6);
        mesh.normals = mesh.positions;
        return mesh;
    }();
    const CurvedSurface surface(coarse);
    for (std::uint32_t i = 0; i < coarse.num_triangles(); ++i) {
        const Triangle& t = coarse.triangles[i];
        EXPECT_NEAR(glm::distance(surface.at(i, {0, 0}), coarse.positions[t[0]]), 0.0f, 1e-6f);
        EXPECT_NEAR(glm::distance(surface.at(i, {1, 0}), coarse.positions[t[1]]), 0.0f, 1e-6f);
        const glm::vec3 flat =
            (coarse.positions[t[0]] + coarse.positions[t[1]] + coarse.positions[t[2]]) / 3.0f;
        const float round = glm::length(surface.at(i, glm::vec2(1.0f / 3.0f)));
        EXPECT_LT(std::abs(1.0f - round), 0.2f * std::abs(1.0f - glm::length(flat)));
        // An edge is the same from both sides.
        for (std::uint32_t j = 0; j < coarse.num_triangles(); ++j)
            for (int k = 0; k < 3; ++k)
                if (coarse.triangles[j][static_cast<std::size_t>(k)] == t[1] &&
                    coarse.triangles[j][static_cast<std::size_t>(k + 1) % 3] == t[0]) {
                    const std::array<glm::vec2, 3> middles = {
                        glm::vec2(0.5f, 0), glm::vec2(0.5f, 0.5f), glm::vec2(0, 0.5f)};
                    EXPECT_NEAR(glm::distance(surface.at(i, {0.5f, 0.0f}),
                                              surface.at(j, middles[static_cast<std::size_t>(k)])),
                                0.0f, 1e-6f);
                }
    }
}

TEST(CurvedSurface, RimsAndCreasesStayStraight) {
    TriangleMesh bowl = sheet(2);
    bowl.normals = {{-0.6f, 0.8f, 0}, {0.6f, 0.8f, 0}, {-0.6f, 0.8f, 0}, {0.6f, 0.8f, 0}};
    const CurvedSurface surface(bowl);
    // Triangle 0 is (0, 2, 1): its side from 0 to 2 is a rim, and so is that from 1 to 0.
    EXPECT_EQ(surface.at(0, {0.5f, 0}), glm::vec3(0, 0, 0.5f));
    EXPECT_EQ(surface.at(0, {0, 0.5f}), glm::vec3(0.5f, 0, 0));
    EXPECT_GT(surface.at(0, {0.5f, 0.5f}).y, 0.05f) << "the diagonal bends";
}

} // namespace
} // namespace relumine::mesh
