#include "mesh/half_edge/diagnosis.h"

#include <map>
#include <set>

#include "mesh/half_edge/winding.h"
#include "tests/mesh/half_edge/shapes.h"
#include "tests/real_data.h"

namespace relumine::mesh {
namespace {

/// The same counts, plainly: maps of sides, and walks around each vertex.
struct Counts {
    std::size_t boundary = 0, non_manifold_edges = 0, repeated_sides = 0, seams = 0, fans = 0,
                isolated = 0, zero_area = 0, duplicates = 0, against = 0, components = 0;
    auto operator<=>(const Counts&) const = default;
};

std::ostream& operator<<(std::ostream& out, const Counts& c) {
    return out << fmt::format("boundary {} non-manifold {} repeated {} seams {} fans {} isolated "
                              "{} zero {} duplicates {} against {} components {}",
                              c.boundary, c.non_manifold_edges, c.repeated_sides, c.seams, c.fans,
                              c.isolated, c.zero_area, c.duplicates, c.against, c.components);
}

bool is_proper(const Triangle& t) {
    return t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
}

/// How many parts of triangles around a vertex no edge at it joins.
std::size_t num_fans(const std::vector<Triangle>& around, std::uint32_t vertex) {
    std::vector<bool> is_seen(around.size());
    const auto joined = [&](const Triangle& a, const Triangle& b) {
        return std::any_of(a.begin(), a.end(), [&](std::uint32_t v) {
            return v != vertex && std::find(b.begin(), b.end(), v) != b.end();
        });
    };
    std::size_t count = 0;
    for (std::size_t first = 0; first < around.size(); ++first) {
        if (is_seen[first])
            continue;
        ++count;
        std::vector<std::size_t> open = {first};
        is_seen[first] = true;
        while (!open.empty()) {
            const std::size_t at = open.back();
            open.pop_back();
            for (std::size_t i = 0; i < around.size(); ++i)
                if (!is_seen[i] && joined(around[at], around[i])) {
                    is_seen[i] = true;
                    open.push_back(i);
                }
        }
    }
    return count;
}

Counts counted(const TriangleMesh& mesh) {
    Counts counts;
    using Place = std::array<float, 3>;
    const auto place = [&](std::uint32_t v) {
        const glm::vec3& p = mesh.positions[v];
        return Place{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};
    };
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> sides, edges;
    std::map<std::set<Place>, std::size_t> places;
    std::map<std::set<std::uint32_t>, std::size_t> sets;
    std::map<std::uint32_t, std::vector<Triangle>> around;
    for (const Triangle& t : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
        const glm::dvec3 normal = glm::cross(b - a, c - a);
        if (glm::length(normal) == 0.0)
            ++counts.zero_area;
        else if (glm::dot(normal, glm::dvec3(mesh.normals[t[0]]) + glm::dvec3(mesh.normals[t[1]]) +
                                      glm::dvec3(mesh.normals[t[2]])) < 0.0)
            ++counts.against;
        std::multiset<std::uint32_t> all(t.begin(), t.end());
        counts.duplicates += sets[{t.begin(), t.end()}]++ > 0 && is_proper(t) ? 1 : 0;
        for (std::size_t k = 0; k < 3; ++k)
            around[t[k]].push_back(t);
        if (!is_proper(t))
            continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t from = t[k], to = t[(k + 1) % 3];
            ++sides[{from, to}];
            ++edges[{std::min(from, to), std::max(from, to)}];
            if (place(from) != place(to))
                ++places[{place(from), place(to)}];
        }
    }
    for (const auto& [edge, count] : edges) {
        counts.boundary += count == 1 ? 1 : 0;
        counts.non_manifold_edges += count > 2 ? 1 : 0;
        counts.seams += count == 1 && places[{place(edge.first), place(edge.second)}] > 1 ? 1 : 0;
    }
    for (const auto& [side, count] : sides)
        counts.repeated_sides += count > 1 ? 1 : 0;
    for (auto& [vertex, triangles] : around) {
        std::erase_if(triangles, [](const Triangle& t) { return !is_proper(t); });
        counts.fans += num_fans(triangles, vertex) > 1 ? 1 : 0;
    }
    // Components: paint triangles until nothing changes.
    std::vector<std::uint32_t> paint(mesh.num_vertices());
    for (std::uint32_t v = 0; v < paint.size(); ++v)
        paint[v] = v;
    for (bool changes = true; changes;) {
        changes = false;
        for (const auto& [a, b, c] : mesh.triangles) {
            const std::uint32_t least = std::min({paint[a], paint[b], paint[c]});
            for (const std::uint32_t v : {a, b, c})
                if (paint[v] != least) {
                    paint[v] = least;
                    changes = true;
                }
        }
    }
    std::set<std::uint32_t> paints;
    for (const auto& [vertex, triangles] : around)
        paints.insert(paint[vertex]);
    counts.components = paints.size();
    counts.isolated = mesh.num_vertices() - around.size();
    return counts;
}

Counts diagnosed(const TriangleMesh& mesh) {
    const Diagnosis d = diagnose(mesh);
    return {.boundary = d.boundary_edges.size(),
            .non_manifold_edges = d.non_manifold_edges.size(),
            .repeated_sides = d.repeated_sides.size(),
            .seams = d.num_seam_edges,
            .fans = d.non_manifold_vertices.size(),
            .isolated = d.isolated_vertices.size(),
            .zero_area = d.zero_area.size(),
            .duplicates = static_cast<std::size_t>(
                std::count_if(d.duplicates.begin(), d.duplicates.end(),
                              [&](std::uint32_t i) { return is_proper(mesh.triangles[i]); })),
            .against = d.against_normals.size(),
            .components = d.num_components};
}

TEST(Diagnosis, AClosedBox) {
    const Diagnosis d = diagnose(box_mesh());
    EXPECT_TRUE(d.is_closed());
    EXPECT_EQ(d.num_components, 1u);
    EXPECT_EQ(diagnosed(box_mesh()), (Counts{.components = 1}));
    EXPECT_TRUE(d.wrongly_wound.empty());
}

TEST(Diagnosis, EachFaultIsCountedAndPlaced) {
    TriangleMesh mesh = box_mesh();
    std::swap(mesh.triangles[3][0], mesh.triangles[3][1]); // wound the wrong way
    mesh.triangles.push_back(mesh.triangles[5]);           // twice
    mesh.triangles.push_back({0, 1, 1});                   // no area
    mesh.positions.emplace_back(9, 9, 9);                  // no triangle
    mesh = with_normals(mesh);
    const Diagnosis d = diagnose(mesh);
    EXPECT_EQ(d.wrongly_wound, (std::vector<std::uint32_t>{3}));
    EXPECT_EQ(d.duplicates, (std::vector<std::uint32_t>{12}));
    EXPECT_EQ(d.zero_area, (std::vector<std::uint32_t>{13}));
    EXPECT_EQ(d.isolated_vertices, (std::vector<std::uint32_t>{8}));
    EXPECT_EQ(d.non_manifold_edges.size(), 3u) << "the edges of the double triangle";
    EXPECT_EQ(diagnosed(mesh), counted(mesh));
}

TEST(Diagnosis, TwoConesThatShareTheirTipAreTwoFans) {
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0},  {1, 1, 0},  {0, 1, 1},  {-1, 1, 0},
                      {1, -1, 0}, {0, -1, 1}, {-1, -1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {0, 5, 4}, {0, 6, 5}, {0, 4, 6}};
    mesh = with_normals(mesh);
    EXPECT_EQ(diagnose(mesh).non_manifold_vertices, (std::vector<std::uint32_t>{0}));
    EXPECT_EQ(diagnosed(mesh), counted(mesh));
}

TEST(Diagnosis, SeamsAreNoHoles) {
    const TriangleMesh flat = with_creases(box_mesh(), 40.0f);
    const Diagnosis d = diagnose(flat);
    EXPECT_EQ(d.boundary_edges.size(), 24u);
    EXPECT_EQ(d.num_seam_edges, 24u);
    EXPECT_TRUE(d.is_closed());
    EXPECT_TRUE(d.wrongly_wound.empty());
    EXPECT_EQ(diagnosed(flat), counted(flat));
}

TEST(Winding, AMoebiusStripHasOneSide) {
    TriangleMesh mesh;
    constexpr std::uint32_t N = 12;
    for (std::uint32_t i = 0; i < N; ++i) {
        const double turn = 3.14159265358979 * i / N, around = 2.0 * turn;
        for (const double side : {-0.3, 0.3}) {
            const double r = 1.0 + side * std::cos(turn);
            mesh.positions.emplace_back(r * std::cos(around), side * std::sin(turn),
                                        r * std::sin(around));
        }
    }
    for (std::uint32_t i = 0; i < N; ++i) {
        const std::uint32_t a = 2 * i, b = a + 1;
        const std::uint32_t c = i + 1 < N ? a + 2 : 1, d = i + 1 < N ? a + 3 : 0;
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({c, b, d});
    }
    EXPECT_GT(find_winding(mesh).num_one_sided, 0u);
    EXPECT_EQ(find_winding(box_mesh()).num_one_sided, 0u);
}

TriangleMesh inside_out(TriangleMesh mesh) {
    for (Triangle& t : mesh.triangles)
        std::swap(t[0], t[1]);
    return mesh;
}

/// The mesh, and another within, smaller by `scale`.
TriangleMesh around(TriangleMesh mesh, const TriangleMesh& inner, float scale = 0.5f) {
    const auto first = static_cast<std::uint32_t>(mesh.num_vertices());
    for (std::size_t i = 0; i < inner.num_vertices(); ++i) {
        mesh.positions.push_back(scale * inner.positions[i]);
        mesh.normals.push_back(inner.normals[i]);
    }
    for (const auto& [a, b, c] : inner.triangles)
        mesh.triangles.push_back({a + first, b + first, c + first});
    return mesh;
}

TEST(Winding, ClosedSurfacesFaceOutwardsButRooms) {
    const TriangleMesh wrong = inside_out(ball(8));
    EXPECT_EQ(find_winding(ball(8)).num_wrong, 0u);
    EXPECT_EQ(find_winding(wrong).num_wrong, ball(8).num_triangles());
    EXPECT_EQ(find_winding(around(ball(8), inside_out(ball(6)))).num_wrong, 0u) << "a bottle";
    EXPECT_EQ(find_winding(around(ball(8), ball(6))).num_wrong, 0u) << "a ball in a case";
    EXPECT_EQ(find_winding(around(wrong, ball(6))).num_wrong, 0u) << "a ball in a room";
    EXPECT_EQ(find_winding(around(wrong, around(ball(6), inside_out(ball(5))))).num_wrong, 0u)
        << "a bottle in a room";
    EXPECT_EQ(find_winding(around(wrong, inside_out(ball(6)))).num_wrong, ball(8).num_triangles())
        << "a bottle whose outer wall is turned";
    TriangleMesh beside = around(wrong, ball(6), 0.4f);
    const TriangleMesh turned = inside_out(ball(6));
    const auto first = static_cast<std::uint32_t>(beside.num_triangles());
    beside = around(beside, turned, 0.1f);
    for (std::size_t i = beside.num_vertices() - turned.num_vertices(); i < beside.num_vertices();
         ++i)
        beside.positions[i].y += 0.7f;
    EXPECT_EQ(find_winding(beside).num_wrong, turned.num_triangles()) << "turned in a right room";
    EXPECT_EQ(find_winding(beside).first_wrong, first);
    // An open sheet keeps the winding that most of it has.
    TriangleMesh open = sheet(5);
    std::swap(open.triangles[7][0], open.triangles[7][2]);
    EXPECT_EQ(find_winding(open).num_wrong, 1u);
    EXPECT_EQ(find_winding(open).first_wrong, 7u);
    EXPECT_EQ(find_winding(inside_out(open)).first_wrong, 7u);
}

TriangleMesh with_normals_turned(TriangleMesh mesh) {
    for (glm::vec3& normal : mesh.normals)
        normal = -normal;
    return mesh;
}

TEST(Winding, NormalsAndWindingSettleOnTheSideThatIsRight) {
    const auto settled = [](TriangleMesh mesh) {
        settle_normals(mesh);
        for (std::uint32_t i = 0; i < mesh.num_triangles(); ++i)
            EXPECT_TRUE(faces_with_normals(mesh, i));
        return mesh;
    };
    const TriangleMesh right = ball(8);
    EXPECT_TRUE(settled(right).warnings.empty());
    // The winding is right.
    const TriangleMesh by_winding = settled(with_normals_turned(right));
    EXPECT_EQ(by_winding.normals, right.normals);
    EXPECT_EQ(by_winding.triangles, right.triangles);
    EXPECT_THAT(by_winding.warnings,
                testing::ElementsAre("114 of 114 normals look into the mesh, against the winding "
                                     "of its triangles: they are turned around"));
    // The normals are right.
    const TriangleMesh by_normals = settled(inside_out(right));
    EXPECT_EQ(by_normals.normals, right.normals);
    EXPECT_GT(volume(by_normals), 0.0);
    EXPECT_THAT(by_normals.warnings,
                testing::ElementsAre("224 of 224 triangles are wound against their normals: they "
                                     "are turned around"));
    // In a room, both of the room.
    const TriangleMesh room = around(with_normals_turned(inside_out(right)), right);
    EXPECT_TRUE(settled(room).warnings.empty());
    EXPECT_EQ(settled(around(inside_out(right), right)).normals, room.normals);
    // Normals of what is open decide.
    const TriangleMesh open = settled(inside_out(sheet(5)));
    EXPECT_EQ(open.normals, sheet(5).normals);
    // A patch that shares a vertex is part of a surface that is not manifold.
    TriangleMesh fan;
    fan.positions = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 0.1f}, {-1, 0, -0.1f}};
    fan.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
    fan.normals = std::vector<glm::vec3>(5, {0, 0, -1});
    settle_normals(fan);
    EXPECT_TRUE(fan.warnings.empty());
    // Uvs stay with their corners.
    TriangleMesh textured = inside_out(sheet(2));
    textured.corner_uvs = {{{{0, 0}, {1, 0}, {2, 0}}}, {{{3, 0}, {4, 0}, {5, 0}}}};
    const Triangle before = textured.triangles[0];
    const TriangleMesh turned = settled(textured);
    for (std::size_t i = 0; i < 3; ++i) {
        const auto k = static_cast<std::size_t>(
            std::find(before.begin(), before.end(), turned.triangles[0][i]) - before.begin());
        ASSERT_LT(k, 3u);
        EXPECT_EQ(turned.corner_uvs[0][i], textured.corner_uvs[0][k]);
    }
}

TEST(Diagnosis, OfRealMeshesAsCountedPlainly) {
    if (real_data_folder().empty())
        GTEST_SKIP() << absent_data("meshes");
    std::size_t num_meshes = 0;
    for (const char* folder : {"meshes/ugly", "meshes/stanford"})
        for (const auto& entry : std::filesystem::directory_iterator(real_data_folder() / folder)) {
            const TriangleMesh mesh = load(entry.path());
            if (mesh.num_triangles() > 20000)
                continue;
            EXPECT_EQ(diagnosed(mesh), counted(mesh)) << entry.path();
            ++num_meshes;
        }
    EXPECT_GE(num_meshes, 35u);
    const std::filesystem::path bunny = real_data("meshes/stanford/bun_zipper_res3.ply");
    if (!bunny.empty()) {
        EXPECT_EQ(diagnose(load(bunny)).repeated_sides.size(), 281u);
    }
}

} // namespace
} // namespace relumine::mesh
