#include "mesh/subject.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mesh/floor.h"
#include "mesh/normals.h"

namespace relumine::mesh {
namespace {

void add_box(TriangleMesh& mesh, const glm::vec3& low, const glm::vec3& high) {
    const auto first = static_cast<std::uint32_t>(mesh.num_vertices());
    for (std::uint32_t i = 0; i < 8; ++i)
        mesh.positions.emplace_back((i & 1u) != 0 ? high.x : low.x, (i & 2u) != 0 ? high.y : low.y,
                                    (i & 4u) != 0 ? high.z : low.z);
    for (const auto& [a, b, c] : {Triangle{0, 2, 1},
                                  {1, 2, 3},
                                  {4, 5, 6},
                                  {5, 7, 6},
                                  {0, 1, 4},
                                  {1, 5, 4},
                                  {2, 6, 3},
                                  {3, 6, 7},
                                  {0, 4, 2},
                                  {2, 4, 6},
                                  {1, 3, 5},
                                  {3, 7, 5}})
        mesh.triangles.push_back({first + a, first + b, first + c});
}

TriangleMesh cube() {
    TriangleMesh mesh;
    add_box(mesh, {-0.5f, 0.0f, -0.5f}, {0.5f, 1.0f, 0.5f});
    return mesh;
}

void add_plane(TriangleMesh& mesh, float half_side) {
    const auto first = static_cast<std::uint32_t>(mesh.num_vertices());
    mesh.positions.insert(mesh.positions.end(), {{-half_side, 0, -half_side},
                                                 {half_side, 0, -half_side},
                                                 {half_side, 0, half_side},
                                                 {-half_side, 0, half_side}});
    mesh.triangles.push_back({first, first + 2, first + 1});
    mesh.triangles.push_back({first, first + 3, first + 2});
}

TEST(Subject, OfAnOrdinaryMeshAllCounts) {
    TriangleMesh mesh = cube();
    add_plane(mesh, 2.0f);
    const Extent found = extent(mesh);
    EXPECT_TRUE(found.counts.empty());
    EXPECT_EQ(found.box.max, bounds(mesh).max);
    EXPECT_EQ(scale(mesh), bounds(mesh).diagonal());
    EXPECT_TRUE(doubts_of_size(mesh).empty());
}

TEST(Subject, TrianglesOfAlphaZeroDoNotCount) {
    TriangleMesh mesh = cube();
    add_box(mesh, glm::vec3(-9.0f), glm::vec3(9.0f));
    mesh.triangle_materials.assign(12, 0);
    mesh.triangle_materials.resize(24, 1);
    mesh.materials = {{.name = "seen"},
                      {.name = "collider", .alpha_mode = AlphaMode::Blend, .alpha = 0.0f}};
    Extent found = extent(mesh);
    EXPECT_EQ(found.num_unseen, 12u);
    EXPECT_EQ(found.box.min, glm::vec3(-0.5f, 0.0f, -0.5f));
    EXPECT_EQ(found.box.max, glm::vec3(0.5f, 1.0f, 0.5f));
    EXPECT_THAT(doubts_of_size(mesh),
                testing::ElementsAre(testing::HasSubstr("12 triangles have an alpha of 0")));
    // The floor stands under what is seen.
    mesh.normals = smooth_normals(mesh);
    TriangleMesh on_floor = mesh;
    append_floor(on_floor, 5);
    EXPECT_NEAR(on_floor.positions[16].y, 0.0f, 0.01f);
    EXPECT_NEAR(on_floor.positions[16].x, -2.0f, 0.01f);
    // Below its cutoff a mask shows nothing, either.
    mesh.materials[1] = {.alpha_mode = AlphaMode::Mask, .alpha = 0.4f, .alpha_cutoff = 0.5f};
    EXPECT_EQ(extent(mesh).num_unseen, 12u);
    mesh.materials[1].alpha = 0.5f;
    EXPECT_EQ(extent(mesh).num_unseen, 0u);
    // Where nothing is seen at all, all of it counts.
    mesh.materials[1].alpha = 0.0f;
    mesh.triangle_materials.assign(24, 1);
    EXPECT_EQ(extent(mesh).num_unseen, 0u);
}

TEST(Subject, AStrayTriangleDoesNotCount) {
    for (const bool is_spike : {false, true}) {
        TriangleMesh mesh;
        for (int i = 0; i < (is_spike ? 200 : 1); ++i) // a spike weighs a thousandth at most
            add_box(mesh, glm::vec3(static_cast<float>(i % 20), 0.0f, static_cast<float>(i / 20)),
                    glm::vec3(static_cast<float>(i % 20) + 1.0f, 1.0f,
                              static_cast<float>(i / 20) + 1.0f));
        const Bounds before = bounds(mesh);
        const auto first = static_cast<std::uint32_t>(mesh.num_vertices());
        const float at = is_spike ? 0.0f : 2000.0f;
        mesh.positions.insert(mesh.positions.end(), {{at, 0.0f, 0.0f},
                                                     {at + 0.01f, 0.0f, 0.0f},
                                                     {2000.0f, is_spike ? 900.0f : 0.01f, 0.0f}});
        mesh.triangles.push_back({first, first + 1, first + 2});
        const Extent found = extent(mesh);
        EXPECT_EQ(found.num_stray, 1u) << is_spike;
        EXPECT_EQ(found.box.min, before.min);
        EXPECT_EQ(found.box.max, before.max);
        EXPECT_EQ(scale(mesh), before.diagonal());
        EXPECT_THAT(doubts_of_size(mesh),
                    testing::ElementsAre(testing::HasSubstr("1 triangles lie ")));
    }
    // What is far and weighs something counts.
    TriangleMesh two = cube();
    add_box(two, {2000.0f, 0.0f, 0.0f}, {2001.0f, 1.0f, 1.0f});
    EXPECT_EQ(extent(two).num_stray, 0u);
}

TEST(Subject, AGroundOfKilometresDoesNotMakeACrateSmall) {
    TriangleMesh mesh = cube();
    add_plane(mesh, 1000.0f);
    EXPECT_EQ(extent(mesh).num_stray, 0u);
    EXPECT_EQ(subject_bounds(mesh).max, glm::vec3(0.5f, 1.0f, 0.5f));
    EXPECT_NEAR(scale(mesh), 10.0f * std::sqrt(3.0f), 1e-3f);
}

/// Low houses around a tower are no plate under it; a slab is, and so is a sheet.
TEST(Subject, ATownOfLowHousesIsNoPlate) {
    TriangleMesh town;
    add_box(town, {0.0f, 0.0f, 0.0f}, {20.0f, 60.0f, 20.0f});
    for (int i = 0; i < 40; ++i) {
        const float x = 100.0f * static_cast<float>(i % 8), z = 100.0f * static_cast<float>(i / 8);
        add_box(town, {x, 0.5f, z}, {x + 12.0f, 7.0f, z + 12.0f});
    }
    EXPECT_EQ(subject_bounds(town).max, glm::vec3(712.0f, 60.0f, 412.0f));
    add_box(town, {-1000.0f, 0.0f, -1000.0f}, {2000.0f, 1.0f, 2000.0f});
    EXPECT_EQ(subject_bounds(town).max, glm::vec3(712.0f, 60.0f, 412.0f));
}

} // namespace
} // namespace relumine::mesh
