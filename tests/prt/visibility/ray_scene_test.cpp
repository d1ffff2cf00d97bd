#include "prt/visibility/ray_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "prt/clusters/lattice.h"
#include "prt/receivers/receivers.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

struct PlainHit {
    std::uint32_t triangle = 0;
    double distance = std::numeric_limits<double>::infinity();
    glm::dvec2 barycentric{0.0};
};

/// Moeller and Trumbore's intersection in double with every triangle; `doubtful` when the ray
/// passes an edge of one so closely that rounding decides.
PlainHit plain_closest_hit(const mesh::TriangleMesh& mesh, const glm::dvec3& origin,
                           const glm::dvec3& direction, double close, bool& doubtful) {
    PlainHit closest;
    doubtful = false;
    for (std::uint32_t i = 0; i < mesh.num_triangles(); ++i) {
        const glm::dvec3 a = mesh.positions[mesh.triangles[i][0]];
        const glm::dvec3 ab = glm::dvec3(mesh.positions[mesh.triangles[i][1]]) - a;
        const glm::dvec3 ac = glm::dvec3(mesh.positions[mesh.triangles[i][2]]) - a;
        const glm::dvec3 p = glm::cross(direction, ac);
        const double determinant = glm::dot(ab, p);
        if (determinant == 0.0)
            continue;
        const glm::dvec3 from_a = origin - a;
        const double u = glm::dot(from_a, p) / determinant;
        const glm::dvec3 q = glm::cross(from_a, ab);
        const double v = glm::dot(direction, q) / determinant;
        const double t = glm::dot(ac, q) / determinant;
        const double inside = std::min({u, v, 1.0 - u - v});
        if (t > 0.0 && std::abs(inside) < close)
            doubtful = true;
        if (inside >= 0.0 && t > 0.0 && t < closest.distance)
            closest = {i, t, {u, v}};
    }
    return closest;
}

DirectionPacket packet_around(std::mt19937& random, const glm::vec3& axis, float spread) {
    DirectionPacket packet;
    packet.num_directions = PacketSize;
    for (std::size_t i = 0; i < PacketSize; ++i)
        packet.set(i, glm::normalize(axis + spread * scenes::random_direction(random)));
    return packet;
}

glm::vec3 direction_of(const DirectionPacket& packet, std::size_t i) {
    return {packet.x[i], packet.y[i], packet.z[i]};
}

TEST(RayScene, PacketsAnswerAsSingleRaysDo) {
    const mesh::TriangleMesh soup = scenes::triangle_soup(60, 1);
    const RayScene scene(soup);
    std::mt19937 random(2);
    std::uniform_real_distribution<float> coordinate(-1.2f, 1.2f);
    std::size_t num_blocked = 0, num_free = 0;
    for (int round = 0; round < 3000; ++round) {
        const glm::vec3 origin(coordinate(random), coordinate(random), coordinate(random));
        const float spread = round % 3 == 0 ? 0.01f : round % 3 == 1 ? 0.3f : 5.0f;
        const DirectionPacket packet =
            packet_around(random, scenes::random_direction(random), spread);
        const std::uint32_t active = random() & 0xffffu;
        const std::uint32_t blocked = scene.occluded(origin, packet, active);
        EXPECT_EQ(blocked & ~active, 0u);
        for (std::uint32_t i = 0; i < PacketSize; ++i) {
            if ((active >> i & 1u) == 0)
                continue;
            const bool alone = scene.occluded(origin, direction_of(packet, i));
            EXPECT_EQ((blocked >> i & 1u) != 0, alone);
            EXPECT_EQ(scene.closest_hit(origin, direction_of(packet, i)).has_value(), alone);
            ++(alone ? num_blocked : num_free);
        }
    }
    EXPECT_GT(num_blocked, 3000u);
    EXPECT_GT(num_free, 5000u);
}

/// Rays against the soup scaled and moved; `close` is the width of an edge in barycentric
/// coordinates inside of which float rounding may decide, `accuracy` the distance error allowed in
/// units of the soup.
void compare_with_every_triangle(float scale, const glm::vec3& offset, double close,
                                 double accuracy) {
    const mesh::TriangleMesh soup =
        scenes::transformed(scenes::triangle_soup(80, 3), scale, offset);
    const RayScene scene(soup);
    std::mt19937 random(4);
    std::uniform_real_distribution<float> coordinate(-1.2f, 1.2f);
    int num_compared = 0, num_hits = 0;
    for (int round = 0; round < 3000; ++round) {
        const glm::vec3 origin =
            scale * glm::vec3(coordinate(random), coordinate(random), coordinate(random)) + offset;
        const glm::vec3 w = scenes::random_direction(random);
        bool doubtful = false;
        const PlainHit expected = plain_closest_hit(soup, origin, w, close, doubtful);
        if (doubtful)
            continue;
        ++num_compared;
        const std::optional<Hit> hit = scene.closest_hit(origin, w);
        ASSERT_EQ(hit.has_value(), std::isfinite(expected.distance)) << "ray " << round;
        ASSERT_EQ(scene.occluded(origin, w), hit.has_value()) << "ray " << round;
        if (!hit)
            continue;
        ++num_hits;
        EXPECT_EQ(hit->triangle, expected.triangle) << "ray " << round;
        EXPECT_NEAR(hit->distance, expected.distance, accuracy * static_cast<double>(scale));
        EXPECT_NEAR(hit->barycentric.x, expected.barycentric.x, close);
        EXPECT_NEAR(hit->barycentric.y, expected.barycentric.y, close);
    }
    EXPECT_GT(num_compared, 2500);
    EXPECT_GT(num_hits, 500);
}

TEST(RayScene, ClosestHitIsThatOfTryingEveryTriangle) {
    // Float geometry of size 1: 2^-24 over the sine of grazing angles and of thin triangles, hence
    // 1e-3.
    compare_with_every_triangle(1.0f, glm::vec3(0.0f), 1e-3, 1e-3);
}

TEST(RayScene, TinyAndHugeCoordinates) {
    compare_with_every_triangle(1e-7f, glm::vec3(0.0f), 1e-3, 1e-3);
    compare_with_every_triangle(1e7f, glm::vec3(0.0f), 1e-3, 1e-3);
    // A scene of size 1e4 about a point 1e7 from the origin, where floats are 1 apart; ray and
    // triangle are both exact floats and Embree works with their differences.
    compare_with_every_triangle(1e4f, glm::vec3(1e7f, -1e7f, 1e7f), 1e-3, 1e-3);
}

TEST(RayScene, NoRayLeavesAClosedMesh) {
    const RayScene scene(scenes::icosphere(3, 1.0f, glm::vec3(0.0f)));
    std::mt19937 random(5);
    for (const Cell cell : {Cell{}, Cell{.face = cubemap::Face::NegativeZ}})
        for (const LatticePoint point : lattice_points(cell))
            EXPECT_TRUE(scene.occluded(glm::vec3(0.0f), direction(point)));
    const mesh::TriangleMesh sphere = scenes::icosphere(3, 1.0f, glm::vec3(0.0f));
    for (const glm::vec3& vertex : sphere.positions) { // through vertices, where six triangles meet
        const glm::vec3 origin = 0.5f * scenes::random_direction(random);
        EXPECT_TRUE(scene.occluded(origin, glm::normalize(vertex - origin)));
    }
    for (const auto& [a, b, c] : sphere.triangles) { // through the middle of edges
        const glm::vec3 middle = 0.5f * (sphere.positions[a] + sphere.positions[b]);
        EXPECT_TRUE(scene.occluded(glm::vec3(0.01f, 0.02f, 0.03f), glm::normalize(middle)));
        EXPECT_TRUE(scene.occluded(glm::vec3(0.0f), glm::normalize(sphere.positions[c])));
    }
}

TEST(RayScene, TrianglesBlockFromBothSides) {
    mesh::TriangleMesh mesh;
    mesh.positions = {{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}};
    mesh.triangles = {{0, 1, 2}};
    const RayScene scene(mesh);
    EXPECT_TRUE(scene.occluded({0, -1, 0}, {0, 1, 0}));
    EXPECT_TRUE(scene.occluded({0, 1, 0}, {0, -1, 0}));
    EXPECT_FALSE(scene.occluded({0, 1, 0}, {0, 1, 0}));
    const std::optional<Hit> hit = scene.closest_hit({0, 2, 0}, {0, -1, 0});
    ASSERT_TRUE(hit);
    EXPECT_FLOAT_EQ(hit->distance, 2.0f);
    EXPECT_FLOAT_EQ(scene.closest_hit({0, 2, 0}, {0, -4, 0})->distance,
                    0.5f); // in units of the direction's length
}

TEST(RayScene, DegenerateTrianglesBlockNothingAndHarmNothing) {
    mesh::TriangleMesh mesh = scenes::triangle_soup(40, 6);
    const RayScene without(mesh);
    const auto n = static_cast<std::uint32_t>(mesh.num_vertices());
    mesh.positions.insert(mesh.positions.end(),
                          {{0, 0, 0}, {1, 1, 1}, {0.5f, 0.5f, 0.5f}, {0, 0, 0}});
    mesh.triangles.push_back({n, n, n});         // a point
    mesh.triangles.push_back({n, n + 1, n});     // an edge twice
    mesh.triangles.push_back({n, n + 1, n + 2}); // three points of a line
    mesh.triangles.push_back({n, n + 3, n + 1}); // two equal points of different names
    const RayScene with(mesh);
    std::mt19937 random(7);
    std::uniform_real_distribution<float> coordinate(-1.2f, 1.2f);
    for (int round = 0; round < 3000; ++round) {
        const glm::vec3 origin(coordinate(random), coordinate(random), coordinate(random));
        const glm::vec3 w = scenes::random_direction(random);
        EXPECT_EQ(with.occluded(origin, w), without.occluded(origin, w));
    }
    // Rays through the line of those corners, beside them: all edge functions are some roundings.
    for (int round = 0; round < 100'000; ++round) {
        const glm::vec3 origin(coordinate(random), coordinate(random), coordinate(random));
        DirectionPacket packet;
        packet.num_directions = PacketSize;
        for (std::size_t lane = 0; lane < PacketSize; ++lane)
            packet.set(lane, glm::normalize(glm::vec3(coordinate(random)) - origin));
        EXPECT_EQ(with.occluded(origin, packet, 0xffff), without.occluded(origin, packet, 0xffff))
            << round;
    }
}

TEST(RayScene, NoTrianglesBlockNothing) {
    const RayScene nothing{mesh::TriangleMesh{}};
    EXPECT_FALSE(nothing.occluded({0, 0, 0}, {0, 1, 0}));
    mesh::TriangleMesh points;
    points.positions = {{0, 0, 0}, {1, 1, 1}};
    EXPECT_FALSE(RayScene(points).closest_hit({0, 0, 0}, {0, 1, 0}));
}

// Embree itself drops such triangles without a word.
TEST(RayScene, RefusesCoordinatesBeyondTheRayTracersRange) {
    const mesh::TriangleMesh sphere = scenes::icosphere(0, 1.0f, glm::vec3(0.0f));
    EXPECT_TRUE(RayScene(scenes::transformed(sphere, 1e18f, glm::vec3(0.0f)))
                    .occluded(glm::vec3(0.0f), {0, 1, 0}));
    for (const float scale : {3e18f, 1e30f, 1e38f, std::numeric_limits<float>::infinity()})
        EXPECT_THROW(RayScene{scenes::transformed(sphere, scale, glm::vec3(0.0f))},
                     std::runtime_error)
            << scale;
    mesh::TriangleMesh with_stray_point = sphere;
    with_stray_point.positions.emplace_back(1e30f);
    EXPECT_TRUE(RayScene(with_stray_point).occluded(glm::vec3(0.0f), {0, 1, 0}));
}

TEST(RayScene, OutlivesItsMeshAndMoves) {
    auto mesh = std::make_unique<mesh::TriangleMesh>(scenes::icosphere(1, 1.0f, glm::vec3(0.0f)));
    RayScene first(*mesh);
    mesh.reset();
    const RayScene second = std::move(first);
    EXPECT_TRUE(second.occluded(glm::vec3(0.0f), {0, 1, 0}));
}

// Receivers on a convex surface see all that is above their faces: the automatic bias is enough.
TEST(RayScene, OnAConvexMeshNothingAboveAllAdjacentFacesIsBlocked) {
    for (const float radius : {1e-6f, 1.0f, 1e6f})
        for (const mesh::TriangleMesh& mesh :
             {scenes::icosphere(2, radius, glm::vec3(0.3f * radius)),
              scenes::box(glm::vec3(-radius), glm::vec3(radius))}) {
            const RayScene scene(mesh);
            const float bias = automatic_bias(mesh);
            std::vector<std::vector<glm::vec3>> face_normals(mesh.num_vertices());
            for (const auto& [a, b, c] : mesh.triangles) {
                const glm::dvec3 p = mesh.positions[a];
                const glm::dvec3 normal = glm::normalize(glm::cross(
                    glm::dvec3(mesh.positions[b]) - p, glm::dvec3(mesh.positions[c]) - p));
                for (const std::uint32_t vertex : {a, b, c})
                    face_normals[vertex].emplace_back(normal);
            }
            std::size_t num_above = 0;
            for (std::uint32_t vertex = 0; vertex < mesh.num_vertices(); ++vertex) {
                const glm::vec3 origin =
                    ray_origin(mesh.positions[vertex], mesh.normals[vertex], bias);
                for (const cubemap::Face face : cubemap::AllFaces)
                    for (std::uint32_t i = 0; i < 64; ++i)
                        for (const LatticePoint point :
                             lattice_points({.face = face, .level = 3, .x = i % 8, .y = i / 8})) {
                            const glm::vec3 w = direction(point);
                            const bool above = std::all_of(
                                face_normals[vertex].begin(), face_normals[vertex].end(),
                                [&](const glm::vec3& n) { return glm::dot(n, w) > 0.0f; });
                            if (!above)
                                continue;
                            ++num_above;
                            ASSERT_FALSE(scene.occluded(origin, w))
                                << "vertex " << vertex << ", radius " << radius;
                        }
            }
            EXPECT_GT(num_above, mesh.num_vertices() * 300);
        }
}

TEST(RayScene, AutomaticBiasScalesWithTheBlockers) {
    const mesh::TriangleMesh mesh = scenes::box(glm::vec3(0.0f), glm::vec3(2.0f, 3.0f, 6.0f));
    EXPECT_FLOAT_EQ(automatic_bias(mesh), 7e-4f);
    EXPECT_FLOAT_EQ(automatic_bias(scenes::transformed(mesh, 100.0f, glm::vec3(5.0f))), 7e-2f);
}

} // namespace
} // namespace relumine::prt
