#include "prt/receivers/texel_receivers.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

/// A rectangle of the plane y = 0, x = u and z = 1 - v, so that a texel's column and row are x and
/// z.
mesh::TriangleMesh rectangle(const glm::vec2& low, const glm::vec2& high) {
    mesh::TriangleMesh mesh;
    mesh.uvs = {{low.x, low.y}, {high.x, low.y}, {low.x, high.y}, {high.x, high.y}};
    for (const glm::vec2& uv : mesh.uvs)
        mesh.positions.emplace_back(uv.x, 0.0f, 1.0f - uv.y);
    mesh.normals.assign(4, glm::vec3(0, 1, 0));
    mesh.triangles = {{0, 1, 3}, {0, 3, 2}};
    return mesh;
}

/// Both, with their uvs.
mesh::TriangleMesh together(mesh::TriangleMesh first, const mesh::TriangleMesh& second) {
    const auto offset = static_cast<std::uint32_t>(first.num_vertices());
    first.positions.insert(first.positions.end(), second.positions.begin(), second.positions.end());
    first.normals.insert(first.normals.end(), second.normals.begin(), second.normals.end());
    first.uvs.insert(first.uvs.end(), second.uvs.begin(), second.uvs.end());
    for (const mesh::Triangle& t : second.triangles)
        first.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
    return first;
}

TEST(TexelReceivers, OfAFullAtlasAreAtTexelCentres) {
    const TexelReceivers texels =
        texel_receivers(rectangle({0, 0}, {1, 1}), {.width = 8, .height = 4});
    ASSERT_EQ(texels.receivers.size(), 32u);
    EXPECT_EQ(texels.report.num_overlapping, 0u); // the diagonal goes through centres
    EXPECT_EQ(texels.report.num_borders, 0u);
    EXPECT_EQ(texels.report.num_outside, 0u);
    for (std::uint32_t i = 0; i < 32; ++i) {
        EXPECT_EQ(texels.layout.texels[i], i);
        const glm::vec3 expected((static_cast<float>(i % 8) + 0.5f) / 8.0f, 0.0f,
                                 (static_cast<float>(i / 8) + 0.5f) /
                                     4.0f); // the top row is at v = 1
        EXPECT_LT(glm::length(texels.receivers.positions[i] - expected), 1e-6f) << i;
        EXPECT_EQ(texels.receivers.normals[i], glm::vec3(0, 1, 0));
    }
    EXPECT_TRUE(texels.receivers.to_eye.empty());
}

TEST(TexelReceivers, ChartsThatEndOnTexelBordersTouchNoNeighbours) {
    const TexelReceivers texels =
        texel_receivers(rectangle({0.25f, 0.5f}, {0.75f, 0.75f}), {.width = 16, .height = 16});
    EXPECT_EQ(texels.receivers.size(), 8u * 4u);
    EXPECT_EQ(texels.report.num_borders, 0u);
    // Also where floats cannot hold the borders.
    const TexelReceivers tenths =
        texel_receivers(rectangle({0.1f, 0.3f}, {0.7f, 0.9f}), {.width = 10, .height = 10});
    EXPECT_EQ(tenths.receivers.size(), 36u);
}

TEST(TexelReceivers, TouchedTexelsGetTheNearestPointOfTheChart) {
    // 2.25 texels wide from column 1.75: it touches columns 1 to 3, and holds the centres of 2
    // and 3.
    const TexelReceivers texels =
        texel_receivers(rectangle({0.175f, 0.2f}, {0.4f, 0.5f}), {.width = 10, .height = 10});
    ASSERT_EQ(texels.receivers.size(), 9u);
    EXPECT_EQ(texels.report.num_borders, 3u);
    for (std::size_t i = 0; i < 9; ++i) {
        const std::uint32_t column = texels.layout.texels[i] % 10;
        const float expected = column == 1 ? 0.175f : (static_cast<float>(column) + 0.5f) / 10.0f;
        EXPECT_NEAR(texels.receivers.positions[i].x, expected, 1e-6f);
        EXPECT_NEAR(texels.receivers.positions[i].z,
                    (static_cast<float>(texels.layout.texels[i] / 10) + 0.5f) / 10.0f, 1e-6f);
    }
}

TEST(TexelReceivers, AgreeWithBruteForceOnRandomTriangles) {
    constexpr std::uint32_t Size = 12;
    constexpr int Steps = 400; // points of a triangle, a side
    std::mt19937 random(7);
    std::uniform_real_distribution<float> place(0.02f, 0.98f);
    for (int round = 0; round < 20; ++round) {
        mesh::TriangleMesh mesh = rectangle({0, 0}, {1, 1});
        mesh.triangles = {{0, 1, 2}};
        mesh.positions.resize(3);
        mesh.normals.resize(3);
        mesh.uvs = {{place(random), place(random)},
                    {place(random), place(random)},
                    {place(random), place(random)}};
        for (std::size_t i = 0; i < 3; ++i)
            mesh.positions[i] = {mesh.uvs[i].x, 0.0f, 1.0f - mesh.uvs[i].y};
        // The nearest of many points of the triangle for each texel, and whether one lies within.
        std::vector<double> nearest(std::size_t{Size} * Size, 1e9);
        std::vector<bool> touched(nearest.size());
        for (int a = 0; a <= Steps; ++a)
            for (int b = 0; a + b <= Steps; ++b) {
                const auto s = static_cast<float>(a) / Steps;
                const auto t = static_cast<float>(b) / Steps;
                const glm::vec3 p = (1.0f - s - t) * mesh.positions[0] + s * mesh.positions[1] +
                                    t * mesh.positions[2];
                for (std::uint32_t i = 0; i < nearest.size(); ++i) {
                    const double dx = static_cast<double>(p.x) * Size - (i % Size + 0.5);
                    const double dz = static_cast<double>(p.z) * Size - (i / Size + 0.5);
                    nearest[i] = std::min(nearest[i], std::hypot(dx, dz));
                    if (std::max(std::abs(dx), std::abs(dz)) < 0.499)
                        touched[i] = true;
                }
            }
        const TexelReceivers texels = texel_receivers(mesh, {.width = Size, .height = Size});
        std::vector<bool> found(nearest.size());
        for (std::size_t i = 0; i < texels.receivers.size(); ++i) {
            const std::uint32_t texel = texels.layout.texels[i];
            found[texel] = true;
            const glm::vec3& p = texels.receivers.positions[i];
            const double distance =
                std::hypot(static_cast<double>(p.x) * Size - (texel % Size + 0.5),
                           static_cast<double>(p.z) * Size - (texel / Size + 0.5));
            EXPECT_LE(distance, nearest[texel] + 1e-4) << round << ' ' << texel;
            EXPECT_GE(distance, nearest[texel] - 0.05) << round << ' ' << texel;
            EXPECT_LT(nearest[texel], 0.5 * std::numbers::sqrt2 + 0.03) << round << ' ' << texel;
        }
        for (std::size_t i = 0; i < found.size(); ++i)
            EXPECT_TRUE(!touched[i] || found[i]) << round << ' ' << i;
    }
}

TEST(TexelReceivers, OverlappingChartsAreCountedAndTheFirstWins) {
    mesh::TriangleMesh second = rectangle({0.25f, 0.25f}, {0.75f, 1.0f});
    for (glm::vec3& position : second.positions)
        position.y = 5.0f;
    const mesh::TriangleMesh both = together(rectangle({0.0f, 0.0f}, {0.5f, 1.0f}), second);
    const TexelReceivers texels = texel_receivers(both, {.width = 8, .height = 8});
    EXPECT_EQ(texels.report.num_overlapping, 2u * 6u);
    EXPECT_EQ(texels.report.first_overlap, 2u);
    ASSERT_EQ(texels.receivers.size(), 4u * 8u + 2u * 6u);
    for (std::size_t i = 0; i < texels.receivers.size(); ++i)
        EXPECT_EQ(texels.receivers.positions[i].y, texels.layout.texels[i] % 8 < 4 ? 0.0f : 5.0f);
}

TEST(TexelReceivers, MirroredChartsAreAsGood) {
    mesh::TriangleMesh mirrored = rectangle({0.0f, 0.0f}, {1.0f, 1.0f});
    for (glm::vec2& uv : mirrored.uvs)
        uv.x = 1.0f - uv.x;
    const TexelReceivers texels = texel_receivers(mirrored, {.width = 4, .height = 4});
    ASSERT_EQ(texels.receivers.size(), 16u);
    EXPECT_EQ(texels.report.num_overlapping, 0u);
    EXPECT_NEAR(texels.receivers.positions[0].x, 0.875f, 1e-6f);
}

TEST(TexelReceivers, UvsOfCornersAreAsGoodAsThoseOfVertices) {
    const mesh::TriangleMesh by_vertex = rectangle({0.1f, 0.2f}, {0.9f, 0.7f});
    mesh::TriangleMesh by_corner = by_vertex;
    for (const mesh::Triangle& t : by_vertex.triangles)
        by_corner.corner_uvs.push_back(
            {by_vertex.uvs[t[0]], by_vertex.uvs[t[1]], by_vertex.uvs[t[2]]});
    by_corner.uvs.clear();
    const TexelReceivers expected = texel_receivers(by_vertex, {.width = 16, .height = 16});
    const TexelReceivers actual = texel_receivers(by_corner, {.width = 16, .height = 16});
    EXPECT_EQ(actual.receivers.positions, expected.receivers.positions);
    EXPECT_EQ(actual.layout, expected.layout);
}

TEST(TexelReceivers, FlatTrianglesAndThoseOutsideAreCounted) {
    mesh::TriangleMesh floor = rectangle({0.0f, 0.0f}, {1.0f, 1.0f});
    floor.uvs.assign(4, glm::vec2(0.0f)); // as mesh::append_floor() leaves them
    mesh::TriangleMesh mesh = together(rectangle({-0.5f, 0.0f}, {0.5f, 0.5f}), floor);
    const TexelReceivers texels = texel_receivers(mesh, {.width = 4, .height = 4});
    EXPECT_EQ(texels.receivers.size(), 4u);
    EXPECT_EQ(texels.report.num_flat, 2u);
    EXPECT_EQ(texels.report.num_outside, 2u);
    mesh.uvs[0] = {-1e30f, 0.0f};
    mesh.uvs[3] = {0.5f, 1e30f};
    static_cast<void>(
        texel_receivers(mesh, {.width = 4, .height = 4})); // ends, and reads nothing outside
}

TEST(TexelReceivers, RefusesMeshesThatHaveNone) {
    mesh::TriangleMesh mesh = rectangle({0.0f, 0.0f}, {1.0f, 1.0f});
    EXPECT_THROW(static_cast<void>(texel_receivers(mesh, {.width = 0, .height = 4})),
                 std::invalid_argument);
    EXPECT_THROW(static_cast<void>(texel_receivers(mesh, {.width = 16384, .height = 16384})),
                 std::invalid_argument);
    mesh.uvs.assign(4, glm::vec2(0.5f));
    EXPECT_THROW(static_cast<void>(texel_receivers(mesh, {.width = 4, .height = 4})),
                 std::invalid_argument);
    mesh.uvs.clear();
    EXPECT_THROW(static_cast<void>(texel_receivers(mesh, {.width = 4, .height = 4})),
                 std::invalid_argument);
}

} // namespace
} // namespace relumine::prt
