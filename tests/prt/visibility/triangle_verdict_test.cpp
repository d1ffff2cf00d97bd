#include "prt/visibility/triangle_verdict.h"

#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "prt/visibility/ray_scene.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

Verdict judge(const glm::vec3 (&corners)[3], const glm::vec3& origin, const glm::vec3& w) {
    TriangleTree::Leaf leaf{};
    leaf.size = 1;
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t a = 0; a < 3; ++a)
            leaf.corners[3 * k + a].fill(corners[k][static_cast<int>(a)]);
    return judge(leaf, 0, origin, w);
}

TEST(TriangleVerdict, KnowsWhatIsFarFromAnEdge) {
    const glm::vec3 triangle[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const glm::vec3 turned[3] = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}};
    for (const float height : {3.0f, -3.0f})
        for (const auto* corners : {&triangle, &turned}) {
            const glm::vec3 w(0, 0, -std::copysign(1.0f, height));
            EXPECT_EQ(judge(*corners, {0.25f, 0.25f, height}, w), Verdict::Hit);
            EXPECT_EQ(judge(*corners, {0.25f, 0.25f, height}, -w), Verdict::Miss);
            EXPECT_EQ(judge(*corners, {0.51f, 0.51f, height}, w), Verdict::Miss);
            EXPECT_EQ(judge(*corners, {-0.01f, 0.5f, height}, w), Verdict::Miss);
        }
}

TEST(TriangleVerdict, LeavesWhatRoundingMayTurn) {
    const glm::vec3 triangle[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const glm::vec3 down(0, 0, -1);
    EXPECT_EQ(judge(triangle, {0.5f, 0.5f, 1}, down), Verdict::Doubt);     // on an edge
    EXPECT_EQ(judge(triangle, {0.5f, 1e-7f, 1}, down), Verdict::Doubt);    // a rounding inside
    EXPECT_EQ(judge(triangle, {0.5f, 1e-5f, 1}, down), Verdict::Hit);      // a hundred
    EXPECT_EQ(judge(triangle, {0.5f, 1e-5f, 1000}, down), Verdict::Doubt); // fewer, so far away
    EXPECT_EQ(judge(triangle, {-1, 0.25f, 0}, {1, 0, 0}), Verdict::Doubt); // along the plane
    EXPECT_EQ(judge(triangle, {0.25f, 0.25f, 0}, down), Verdict::Doubt);   // from the plane
    EXPECT_EQ(judge(triangle, {2, 0.25f, 0}, {0, 0.8f, 0.6f}),
              Verdict::Miss); // from beside it in its plane
}

/// Triangles of all shapes and distances, and rays close to their edges and corners: what is
/// certain is what the ray tracer says.
TEST(TriangleVerdict, NeverContradictsTheRayTracer) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
    const auto power = [&](float least) {
        return std::pow(10.0f, least * 0.5f * (1.0f - uniform(random)));
    };
    std::size_t counts[3] = {};
    for (int i = 0; i < 20'000; ++i) {
        mesh::TriangleMesh mesh;
        const glm::vec3 place = scenes::random_direction(random);
        const float size = power(-4.0f);
        const glm::vec3 along = size * scenes::random_direction(random);
        mesh.positions = {place, place + along,
                          place + uniform(random) * along +
                              size * power(-4.0f) * scenes::random_direction(random)};
        mesh.triangles = {{0, 1, 2}};
        const glm::vec3 corners[3] = {mesh.positions[0], mesh.positions[1], mesh.positions[2]};
        const RayScene rays(mesh);
        for (int j = 0; j < 20; ++j) {
            // Towards a point on an edge or its extension, and a little beside.
            const auto k = static_cast<std::size_t>(random() % 3);
            const glm::vec3 target =
                glm::mix(corners[k], corners[(k + 1) % 3], 1.2f * uniform(random)) +
                size * power(-7.0f) * scenes::random_direction(random);
            const glm::vec3 origin = 0.01f * scenes::random_direction(random);
            const glm::vec3 w = glm::normalize(target - origin);
            const Verdict verdict = judge(corners, origin, w);
            ++counts[static_cast<std::size_t>(verdict)];
            if (verdict == Verdict::Doubt)
                continue;
            DirectionPacket packet;
            packet.num_directions = 1;
            for (std::size_t lane = 0; lane < PacketSize; ++lane)
                packet.set(lane, w);
            ASSERT_EQ(rays.occluded(origin, packet, 1u), verdict == Verdict::Hit ? 1u : 0u)
                << i << " " << j;
        }
    }
    for (const std::size_t count : counts)
        EXPECT_GT(count, 10'000u);
}

} // namespace
} // namespace relumine::prt
