#include "mesh/half_edge/repair.h"

#include "mesh/half_edge/diagnosis.h"
#include "mesh/half_edge/half_edge_mesh.h"
#include "tests/mesh/half_edge/shapes.h"
#include "tests/real_data.h"

namespace relumine::mesh {
namespace {

void expect_same(const TriangleMesh& a, const TriangleMesh& b, const std::string& what = "") {
    EXPECT_EQ(a.positions, b.positions) << what;
    EXPECT_EQ(a.triangles, b.triangles) << what;
    EXPECT_EQ(a.normals, b.normals) << what;
    EXPECT_EQ(a.colors, b.colors) << what;
    EXPECT_EQ(a.uvs, b.uvs) << what;
    EXPECT_EQ(a.corner_uvs, b.corner_uvs) << what;
    EXPECT_EQ(a.triangle_materials, b.triangle_materials) << what;
    EXPECT_EQ(a.triangle_groups, b.triangle_groups) << what;
}

/// Every other attribute, so that nothing is lost in silence.
TriangleMesh dressed(TriangleMesh mesh) {
    mesh.materials = {{.name = "a"}, {.name = "b"}};
    mesh.groups = {"left", "right"};
    for (std::uint32_t i = 0; i < mesh.num_triangles(); ++i) {
        mesh.triangle_materials.push_back(i % 2);
        mesh.triangle_groups.push_back(i / 2 % 2);
        mesh.corner_uvs.push_back({glm::vec2(i, 0), glm::vec2(i, 1), glm::vec2(i, 2)});
    }
    for (std::size_t i = 0; i < mesh.num_vertices(); ++i)
        mesh.colors.emplace_back(static_cast<float>(i), 0.5f, 0.25f);
    return mesh;
}

TEST(Repair, ASoundMeshStaysAsItIs) {
    for (const TriangleMesh& mesh : {dressed(box_mesh()), dressed(sheet(4)), dressed(ball(6))}) {
        RepairReport report;
        expect_same(repair(mesh, {}, &report), mesh);
        EXPECT_TRUE(report.is_nothing());
    }
}

TEST(Repair, TurnsDropsAndKeepsWhatIsAtTheTriangles) {
    const TriangleMesh sound = dressed(ball(8));
    TriangleMesh mesh = sound;
    for (const std::size_t i : {3u, 40u, 41u}) {
        std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
        std::swap(mesh.corner_uvs[i][1], mesh.corner_uvs[i][2]);
    }
    mesh.triangles.push_back(mesh.triangles[7]);
    mesh.triangles.push_back({1, 1, 2});
    for (int i = 0; i < 2; ++i) {
        mesh.triangle_materials.push_back(1);
        mesh.triangle_groups.push_back(1);
        mesh.corner_uvs.emplace_back();
    }
    RepairReport report;
    const TriangleMesh mended = repair(mesh, {}, &report);
    expect_same(mended, sound);
    EXPECT_EQ(report.num_turned, 3u);
    EXPECT_EQ(report.num_duplicates, 1u);
    EXPECT_EQ(report.num_zero_area, 1u);
}

TEST(Repair, TwoTrianglesThatFoldBackGoTogether) {
    TriangleMesh mesh = sheet(5);
    const Triangle t = mesh.triangles[12];
    mesh.triangles.push_back({t[0], t[1], t[2]});
    mesh.triangles.push_back({t[2], t[1], t[0]});
    // Three of one place: a pair may not cancel the surface itself.
    EXPECT_EQ(repair(mesh).triangles.size(), sheet(5).triangles.size());
    // A leaf of two sides keeps one of them.
    TriangleMesh leaf = sheet(3);
    const std::vector<Triangle> front = leaf.triangles;
    for (const auto& [a, b, c] : front)
        leaf.triangles.push_back({c, b, a});
    EXPECT_EQ(repair(leaf).triangles, front);
}

TEST(Repair, WeldsPlacesAndKeepsUvsAtCorners) {
    TriangleMesh flat = with_creases(box_mesh(), 40.0f);
    for (std::size_t i = 0; i < flat.num_vertices(); ++i)
        flat.uvs.emplace_back(static_cast<float>(i), 1.0f);
    RepairReport report;
    const TriangleMesh welded = repair(flat, {.weld = true}, &report);
    EXPECT_EQ(report.num_welded, 16u);
    EXPECT_EQ(welded.num_vertices(), 8u);
    EXPECT_TRUE(welded.uvs.empty());
    ASSERT_EQ(welded.corner_uvs.size(), flat.num_triangles());
    for (std::size_t i = 0; i < flat.num_triangles(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_EQ(welded.corner_uvs[i][k], flat.uvs[flat.triangles[i][k]]);
            EXPECT_EQ(welded.positions[welded.triangles[i][k]],
                      flat.positions[flat.triangles[i][k]]);
        }
    EXPECT_NEAR(glm::distance(welded.normals[6], box_mesh().normals[6]), 0.0f, 1e-6f);
    EXPECT_EQ(repair(flat).num_vertices(), 24u) << "not told to";
    // Other colours stay apart.
    flat.colors.assign(flat.num_vertices(), glm::vec3(0.0f));
    flat.colors[3] = glm::vec3(1.0f);
    EXPECT_EQ(repair(flat, {.weld = true}).num_vertices(), 9u);
}

TEST(Repair, ClosesHolesUpToASize) {
    TriangleMesh mesh = ball(12);
    const double whole = volume(mesh);
    mesh.triangles.erase(mesh.triangles.begin() + 30, mesh.triangles.begin() + 32);
    const std::size_t rim = diagnose(mesh).boundary_edges.size();
    EXPECT_FALSE(diagnose(mesh).is_closed());
    RepairReport report;
    EXPECT_EQ(repair(mesh, {.fill_holes = static_cast<std::uint32_t>(rim - 1)}, &report).triangles,
              mesh.triangles);
    const TriangleMesh closed =
        repair(mesh, {.fill_holes = static_cast<std::uint32_t>(rim)}, &report);
    EXPECT_EQ(report.num_filled, 1u);
    EXPECT_EQ(report.num_new_triangles, rim - 2);
    EXPECT_TRUE(diagnose(closed).is_closed());
    EXPECT_TRUE(diagnose(closed).repeated_sides.empty());
    EXPECT_NEAR(volume(closed), whole, 0.01 * whole);
    EXPECT_EQ(closed.positions, mesh.positions);
    // The border of a sheet is no hole.
    EXPECT_EQ(repair(sheet(4), {.fill_holes = 100}).triangles, sheet(4).triangles);
    // Nor are the seams of a box with flat normals.
    const TriangleMesh flat = with_creases(box_mesh(), 40.0f);
    EXPECT_EQ(repair(flat, {.fill_holes = 100}).triangles, flat.triangles);
}

TEST(Repair, ARimThatIsMetTwiceIsRefused) {
    // Two holes of a ball that touch at a vertex.
    TriangleMesh mesh = ball(8);
    const std::uint32_t corner = mesh.triangles[40][0];
    std::vector<std::size_t> around;
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i)
        if (std::find(mesh.triangles[i].begin(), mesh.triangles[i].end(), corner) !=
            mesh.triangles[i].end())
            around.push_back(i);
    const auto share = [&](std::size_t i, std::size_t j) {
        return std::count_if(mesh.triangles[i].begin(), mesh.triangles[i].end(),
                             [&](std::uint32_t v) {
                                 const Triangle& t = mesh.triangles[j];
                                 return std::find(t.begin(), t.end(), v) != t.end();
                             });
    };
    const auto across = std::find_if(around.begin() + 1, around.end(),
                                     [&](std::size_t j) { return share(around.front(), j) == 1; });
    ASSERT_NE(across, around.end());
    mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(*across));
    mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(around.front()));
    EXPECT_THROW(static_cast<void>(repair(mesh, {.fill_holes = 10})), std::runtime_error);
    EXPECT_NO_THROW(static_cast<void>(repair(mesh)));
    EXPECT_THROW(static_cast<void>(repair(mesh, {.fill_holes = LongestRim + 1})),
                 std::invalid_argument);
}

TEST(Repair, NothingLeftIsRefused) {
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    mesh.triangles = {{0, 1, 2}};
    mesh.normals.resize(3);
    EXPECT_THROW(static_cast<void>(repair(mesh)), std::runtime_error);
}

TEST(Repair, OfRealMeshesTwiceIsOnce) {
    if (real_data_folder().empty())
        GTEST_SKIP() << absent_data("meshes");
    for (const char* folder : {"meshes/ugly", "meshes/stanford"})
        for (const auto& entry : std::filesystem::directory_iterator(real_data_folder() / folder)) {
            const TriangleMesh mesh = load(entry.path());
            if (mesh.num_triangles() > 20000)
                continue;
            for (const RepairOptions& options : {RepairOptions{}, RepairOptions{.weld = true}}) {
                const TriangleMesh once = repair(mesh, options);
                RepairReport report;
                expect_same(repair(once, options, &report), once, entry.path().string());
                EXPECT_TRUE(report.is_nothing()) << entry.path();
                const Diagnosis found = diagnose(once);
                EXPECT_TRUE(found.wrongly_wound.empty()) << entry.path();
                EXPECT_TRUE(found.zero_area.empty()) << entry.path();
                EXPECT_TRUE(found.duplicates.empty()) << entry.path();
                if (found.num_one_sided == 0 && found.non_manifold_edges.empty()) {
                    EXPECT_TRUE(found.repeated_sides.empty()) << entry.path();
                }
            }
        }
    const std::filesystem::path bunny = real_data("meshes/stanford/bun_zipper_res3.ply");
    if (!bunny.empty()) {
        EXPECT_LT(diagnose(repair(load(bunny))).repeated_sides.size(), 40u) << "of 281";
    }
}

TEST(HalfEdgeMesh, EverythingComesBack) {
    for (const TriangleMesh& mesh : {dressed(box_mesh()), dressed(sheet(4)), dressed(ball(6))})
        for (const auto cuts : {HalfEdgeMesh::Cuts::Attributes}) {
            const TriangleMesh back = HalfEdgeMesh(mesh, cuts).mesh();
            expect_same(back, mesh);
            EXPECT_EQ(back.materials, mesh.materials);
            EXPECT_EQ(back.groups, mesh.groups);
        }
}

TEST(HalfEdgeMesh, FansAreSplitAndJoinedAgain) {
    // Three triangles at one edge, two cones at one tip.
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0},   {0, 1, 0},  {1, 0, 0},  {-1, 0, 1},
                      {-1, 0, -1}, {0, -1, 1}, {0, -1, -1}};
    mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}, {0, 5, 6}};
    mesh = with_normals(mesh);
    expect_same(HalfEdgeMesh(mesh, HalfEdgeMesh::Cuts::Attributes).mesh(), mesh);
    std::size_t num_cut = 0;
    for (const auto& rim : HalfEdgeMesh(mesh, HalfEdgeMesh::Cuts::Shape).rims())
        for (const auto& corner : rim)
            num_cut += corner.is_cut ? 1 : 0;
    EXPECT_GT(num_cut, 0u);
}

} // namespace
} // namespace relumine::mesh
