#include "prt/receivers.h"

#include <algorithm>
#include <numeric>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

Receivers random_receivers(std::size_t n, std::uint32_t seed, float zero_normals) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> coordinate(-5.0f, 5.0f);
    std::bernoulli_distribution zero(zero_normals);
    Receivers receivers;
    for (std::size_t i = 0; i < n; ++i) {
        receivers.positions.emplace_back(coordinate(random), coordinate(random), coordinate(random));
        receivers.normals.push_back(zero(random) ? glm::vec3(0.0f) : scenes::random_direction(random));
    }
    return receivers;
}

void expect_permutation(std::vector<std::uint32_t> order) {
    std::sort(order.begin(), order.end());
    std::vector<std::uint32_t> all(order.size());
    std::iota(all.begin(), all.end(), 0u);
    EXPECT_EQ(order, all);
}

TEST(Receivers, OnePerVertexInTheMeshsOrder) {
    const mesh::TriangleMesh mesh = scenes::icosphere(1, 2.0f, {1, 2, 3});
    const Receivers receivers = vertex_receivers(mesh);
    EXPECT_EQ(receivers.positions, mesh.positions);
    EXPECT_EQ(receivers.normals, mesh.normals);
}

TEST(Receivers, SpatialOrderIsAPermutationWithZeroNormalsLast) {
    for (const float zero_normals : {0.0f, 0.3f, 1.0f}) {
        const Receivers receivers = random_receivers(1000, 1, zero_normals);
        const std::vector<std::uint32_t> order = spatial_order(receivers);
        ASSERT_EQ(order.size(), receivers.size());
        expect_permutation(order);
        EXPECT_TRUE(std::is_partitioned(order.begin(), order.end(), [&](std::uint32_t i) {
            return receivers.normals[i] != glm::vec3(0.0f);
        }));
    }
}

TEST(Receivers, SpatialOrderPutsNeighboursTogether) {
    const Receivers receivers = random_receivers(4096, 2, 0.0f);
    const std::vector<std::uint32_t> order = spatial_order(receivers);
    const auto path = [&](const auto& place) {
        double length = 0.0;
        for (std::uint32_t i = 0; i + 1 < receivers.size(); ++i)
            length += glm::distance(receivers.positions[place(i)], receivers.positions[place(i + 1)]);
        return length;
    };
    // Random points on a Z curve are a few grid steps apart: 10 / 16 beside a mean distance of 6.6.
    EXPECT_LT(path([&](std::uint32_t i) { return order[i]; }), 0.2 * path([](std::uint32_t i) { return i; }));
}

TEST(Receivers, SpatialOrderSortsTheOctantsOfACube) {
    Receivers receivers;
    for (std::uint32_t i = 0; i < 8; ++i) {
        const std::uint32_t corner = 7 - i; // given in reverse
        receivers.positions.emplace_back(corner & 1u, corner >> 1u & 1u, corner >> 2u);
        receivers.normals.emplace_back(0.0f, 1.0f, 0.0f);
    }
    EXPECT_EQ(spatial_order(receivers), (std::vector<std::uint32_t>{7, 6, 5, 4, 3, 2, 1, 0}));
}

TEST(Receivers, SpatialOrderKeepsTheOrderOfEqualPositions) {
    const Receivers receivers{.positions = std::vector<glm::vec3>(100, glm::vec3(3.0f)),
                              .normals = std::vector<glm::vec3>(100, glm::vec3(1.0f, 0.0f, 0.0f))};
    std::vector<std::uint32_t> all(100);
    std::iota(all.begin(), all.end(), 0u);
    EXPECT_EQ(spatial_order(receivers), all);
    EXPECT_TRUE(spatial_order(Receivers{}).empty());
}

TEST(Receivers, SpatialOrderStandsAnyCoordinates) {
    for (const float size : {1e-40f, 1e-30f, 1e7f, 1e38f, 3e38f}) {
        Receivers receivers = random_receivers(200, 3, 0.1f);
        for (glm::vec3& position : receivers.positions)
            position *= size / 5.0f;
        expect_permutation(spatial_order(receivers));
    }
}

} // namespace
} // namespace relumine::prt
