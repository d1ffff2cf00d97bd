#include "mesh/flat_regions.h"

#include <array>
#include <cmath>
#include <functional>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "mesh/exact_sign.h"

namespace relumine::mesh {
namespace {

/// (n + 1)^2 points, n^2 squares of two triangles each, at place(i, j); `keep(i, j)` says which
/// squares are there.
TriangleMesh grid(
    std::uint32_t n, const std::function<glm::vec3(float, float)>& place,
    const std::function<bool(std::uint32_t, std::uint32_t)>& keep = [](auto, auto) {
        return true;
    }) {
    TriangleMesh mesh;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i)
            mesh.positions.push_back(place(static_cast<float>(i), static_cast<float>(j)));
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i)
            if (keep(i, j)) {
                const std::uint32_t a = j * (n + 1) + i;
                mesh.triangles.push_back({a, a + 1, a + n + 2});
                mesh.triangles.push_back({a, a + n + 2, a + n + 1});
            }
    return mesh;
}

glm::vec3 flat(float i, float j) {
    return {0.1f * i - 0.3f, 0.7f, 0.1f * j + 5.0f};
}

glm::dvec3 area_vector(const TriangleMesh& mesh, const std::vector<Triangle>& triangles) {
    glm::dvec3 sum(0.0);
    for (const auto& [a, b, c] : triangles)
        sum += 0.5 * glm::cross(glm::dvec3(mesh.positions[b]) - glm::dvec3(mesh.positions[a]),
                                glm::dvec3(mesh.positions[c]) - glm::dvec3(mesh.positions[a]));
    return sum;
}

std::size_t num_merged(const TriangleMesh& mesh) {
    const std::vector<Triangle> merged = with_flat_regions_merged(mesh);
    const glm::dvec3 before = area_vector(mesh, mesh.triangles);
    EXPECT_LT(glm::length(area_vector(mesh, merged) - before), 1e-12 * (1.0 + glm::length(before)));
    return merged.size();
}

TEST(ExactSign, TurnsAreThoseOfIntegers) {
    std::mt19937 random(1);
    std::uniform_int_distribution<int> small(-3, 3);
    int num_straight = 0;
    for (int round = 0; round < 20000; ++round) {
        std::array<std::array<std::int64_t, 2>, 3> p;
        for (auto& point : p)
            for (std::int64_t& x : point)
                x = (1 << 23) + small(random); // differences of huge products
        const std::int64_t expected =
            (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
        const auto at = [&](std::size_t i) {
            return glm::vec2(static_cast<float>(p[i][0]), static_cast<float>(p[i][1])) * 0x1p-40f;
        };
        EXPECT_EQ(turn(at(0), at(1), at(2)), (expected > 0) - (expected < 0));
        num_straight += static_cast<int>(expected == 0);
    }
    EXPECT_GT(num_straight, 1000);
}

TEST(ExactSign, CoplanarIsThatOfIntegers) {
    std::mt19937 random(2);
    std::uniform_int_distribution<int> small(-2, 2);
    int num_coplanar = 0;
    for (int round = 0; round < 20000; ++round) {
        std::array<std::array<std::int64_t, 3>, 4> p;
        for (auto& point : p)
            for (std::int64_t& x : point)
                x = (1 << 22) + 31 * small(random);
        std::array<std::array<std::int64_t, 3>, 3> d;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t k = 0; k < 3; ++k)
                d[i][k] = p[i + 1][k] - p[0][k];
        const std::int64_t volume = d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) +
                                    d[0][1] * (d[1][2] * d[2][0] - d[1][0] * d[2][2]) +
                                    d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
        const auto at = [&](std::size_t i) {
            return glm::vec3(static_cast<float>(p[i][0]), static_cast<float>(p[i][1]),
                             static_cast<float>(p[i][2]));
        };
        EXPECT_EQ(coplanar(at(0), at(1), at(2), at(3)), volume == 0);
        num_coplanar += static_cast<int>(volume == 0);
    }
    EXPECT_GT(num_coplanar, 1000);
    // One step of the last bit is seen at any size.
    for (const float scale : {1e-12f, 1.0f, 1e12f}) {
        const glm::vec3 a(0.0f), b(scale, 0, scale), c(0, scale, scale),
            d(scale, scale, 2.0f * scale);
        EXPECT_TRUE(coplanar(a, b, c, d));
        EXPECT_FALSE(coplanar(a, b, c, {d.x, d.y, std::nextafter(d.z, 0.0f)}));
    }
}

TEST(FlatRegions, AFloorIsTwoTriangles) {
    EXPECT_EQ(num_merged(grid(1, flat)), 2u);
    EXPECT_EQ(num_merged(grid(20, flat)), 2u);
    // A slanted plane of exact floats.
    EXPECT_EQ(
        num_merged(grid(8, [](float i, float j) { return glm::vec3(i, 0.25f * i - 0.5f * j, j); })),
        2u);
    // Uneven spacing, and a triangle as outline.
    EXPECT_EQ(num_merged(grid(
                  8, [](float i, float j) { return glm::vec3(i * i, 1.0f, j + 0.125f * j * j); })),
              2u);
    TriangleMesh half = grid(
        4, [](float i, float j) { return glm::vec3(i, 2.0f, j); },
        [](std::uint32_t i, std::uint32_t j) { return i > j; });
    for (std::uint32_t i = 0; i < 4; ++i)
        half.triangles.push_back({i * 6, i * 6 + 1, i * 6 + 6});
    EXPECT_EQ(num_merged(half), 1u);
}

TEST(FlatRegions, OutlinesThatAreNotConvexStay) {
    const auto unchanged = [](const TriangleMesh& mesh) {
        EXPECT_EQ(with_flat_regions_merged(mesh), mesh.triangles);
    };
    unchanged(
        grid(5, flat, [](std::uint32_t i, std::uint32_t j) { return i != 2 || j != 2; })); // a hole
    unchanged(
        grid(5, flat, [](std::uint32_t i, std::uint32_t j) { return i < 2 || j < 2; })); // an L
    // Two squares that touch in a point are two regions.
    EXPECT_EQ(num_merged(grid(4, flat,
                              [](std::uint32_t i, std::uint32_t j) { return (i < 2) == (j < 2); })),
              4u);
}

TEST(FlatRegions, WhatIsNotExactlyFlatStays) {
    const TriangleMesh wavy =
        grid(6, [](float i, float j) { return glm::vec3(i, 0.1f * i * j, j); });
    EXPECT_EQ(with_flat_regions_merged(wavy), wavy.triangles);
    TriangleMesh dented = grid(
        6,
        flat); // by one step of the last bit: the triangles around it stay, so the rest has a hole
    dented.positions[3 * 7 + 3].y = std::nextafter(0.7f, 1.0f);
    EXPECT_EQ(num_merged(dented), dented.triangles.size());
}

TEST(FlatRegions, FoldsAndSharedEdgesAreOutlines) {
    // Two sheets that lie on each other, joined along one side: folded, not flat.
    TriangleMesh folded = grid(4, flat);
    const auto n = static_cast<std::uint32_t>(folded.num_vertices());
    for (std::uint32_t i = 0; i < n; ++i)
        folded.positions.push_back(flat(static_cast<float>(i % 5), -static_cast<float>(i / 5)));
    EXPECT_EQ(num_merged(folded), 2u);
    TriangleMesh crease;
    crease.positions = {{0, 0, 0}, {1, 0, 0}, {0.25f, 1, 0}, {0.75f, 1, 0}, {2, 2, 0}};
    crease.triangles = {{0, 1, 2}, {1, 0, 3}, {1, 3, 4}};
    EXPECT_EQ(with_flat_regions_merged(crease).size(), 3u);

    // A wall stands on the middle line of a floor: its edge has four triangles, the floor falls
    // into two rectangles.
    TriangleMesh wall = grid(4, flat);
    const auto base = static_cast<std::uint32_t>(wall.num_vertices());
    for (std::uint32_t i = 0; i < 5; ++i)
        wall.positions.push_back(flat(static_cast<float>(i), 2.0f) + glm::vec3(0, 1, 0));
    for (std::uint32_t i = 0; i < 4; ++i) {
        wall.triangles.push_back({10 + i, 11 + i, base + i + 1});
        wall.triangles.push_back({10 + i, base + i + 1, base + i});
    }
    EXPECT_EQ(num_merged(wall), 6u);
}

TEST(FlatRegions, HarmlessOnDegenerateMeshes) {
    EXPECT_TRUE(with_flat_regions_merged({}).empty());
    TriangleMesh mesh = grid(3, flat);
    mesh.triangles.push_back({0, 0, 1});
    mesh.triangles.push_back({5, 5, 5});
    mesh.triangles.push_back({0, 1, 2}); // three points of a line
    num_merged(mesh);
    TriangleMesh twice = grid(3, flat);
    twice.triangles.insert(twice.triangles.end(), twice.triangles.begin(), twice.triangles.end());
    EXPECT_EQ(num_merged(twice),
              twice.triangles.size()); // every edge has four triangles, or two of one direction
}

} // namespace
} // namespace relumine::mesh
