#include "prt/receivers/receiver_order.h"

#include <algorithm>
#include <numeric>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "files/parallel.h"
#include "prt/transfer/visible_counts.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

Receivers random_receivers(std::size_t n, std::uint32_t seed, float zero_normals) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> coordinate(-5.0f, 5.0f);
    std::bernoulli_distribution zero(zero_normals);
    Receivers receivers;
    for (std::size_t i = 0; i < n; ++i) {
        receivers.positions.emplace_back(coordinate(random), coordinate(random),
                                         coordinate(random));
        receivers.normals.push_back(zero(random) ? glm::vec3(0.0f)
                                                 : scenes::random_direction(random));
    }
    return receivers;
}

void expect_permutation(std::vector<std::uint32_t> order) {
    std::sort(order.begin(), order.end());
    std::vector<std::uint32_t> all(order.size());
    std::iota(all.begin(), all.end(), 0u);
    EXPECT_EQ(order, all);
}

TEST(ReceiverOrder, IsAPermutationWithZeroNormalsLast) {
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

/// Mean distance of two receivers of the same block.
double mean_distance(const std::vector<glm::vec3>& values,
                     const std::vector<std::uint32_t>& order) {
    double sum = 0.0;
    std::size_t num_pairs = 0;
    for (std::size_t begin = 0; begin + BlockSize <= order.size(); begin += BlockSize)
        for (std::size_t i = begin; i < begin + BlockSize; ++i)
            for (std::size_t j = begin; j < i; ++j, ++num_pairs)
                sum += glm::distance(values[order[i]], values[order[j]]);
    return sum / static_cast<double>(num_pairs);
}

TEST(ReceiverOrder, PutsNeighboursIntoABlock) {
    // All face alike: then only the place counts. 256 blocks in a cube of side 10: cubes of
    // side 1.57, in which the mean distance is 0.66 sides.
    Receivers receivers = random_receivers(4096, 2, 0.0f);
    receivers.normals.assign(receivers.size(), glm::vec3(0.0f, 1.0f, 0.0f));
    EXPECT_LT(mean_distance(receivers.positions, spatial_order(receivers)), 1.5 * 0.66 * 1.57);
}

TEST(ReceiverOrder, PutsThoseThatFaceAlikeIntoABlock) {
    // A grid of 128 x 128 places on a sheet, the receivers of both sides in turn.
    Receivers receivers;
    for (std::uint32_t i = 0; i < 2 * 128 * 128; ++i) {
        receivers.positions.emplace_back(i / 2 % 128, 0.0f, i / 256);
        receivers.normals.emplace_back(0.0f, i % 2 == 0 ? 1.0f : -1.0f, 0.0f);
    }
    EXPECT_EQ(mean_distance(receivers.normals, spatial_order(receivers)), 0.0);
}

TEST(ReceiverOrder, GroupsBeginAtMultiplesOfTheBlock) {
    // 5 blocks and 3 receivers more, in clouds far from each other of 16 and 3: no block holds
    // parts of two.
    Receivers receivers = random_receivers(5 * BlockSize + 3, 4, 0.0f);
    for (std::size_t i = 0; i < receivers.size(); ++i)
        receivers.positions[i].x =
            receivers.positions[i].x * 0.01f + 100.0f * static_cast<float>(i / BlockSize);
    const std::vector<std::uint32_t> order = spatial_order(receivers);
    for (std::size_t place = 0; place < order.size(); ++place)
        EXPECT_EQ(order[place], place);
}

TEST(ReceiverOrder, KeepsTheOrderOfEqualReceivers) {
    const Receivers receivers{.positions = std::vector<glm::vec3>(100, glm::vec3(3.0f)),
                              .normals = std::vector<glm::vec3>(100, glm::vec3(1.0f, 0.0f, 0.0f))};
    std::vector<std::uint32_t> all(100);
    std::iota(all.begin(), all.end(), 0u);
    EXPECT_EQ(spatial_order(receivers), all);
    EXPECT_TRUE(spatial_order(Receivers{}).empty());
}

TEST(ReceiverOrder, StandsAnyCoordinates) {
    for (const float size : {1e-40f, 1e-30f, 1e7f, 1e38f, 3e38f}) {
        Receivers receivers = random_receivers(200, 3, 0.1f);
        for (glm::vec3& position : receivers.positions)
            position *= size / 5.0f;
        expect_permutation(spatial_order(receivers));
    }
}

TEST(ReceiverOrder, IsTheSameOnOneThread) {
    const Receivers receivers = random_receivers(20000, 5, 0.01f);
    const std::vector<std::uint32_t> parallel = spatial_order(receivers);
    const files::ThreadLimit one(1);
    EXPECT_EQ(spatial_order(receivers), parallel);
}

TEST(ReceiverOrder, AddedVerticesStandTogetherAfterTheOthers) {
    Receivers receivers = random_receivers(1000, 3, 0.1f);
    receivers.num_added = 300;
    const std::vector<std::uint32_t> order = spatial_order(receivers);
    expect_permutation(order);
    const auto rank = [&](std::uint32_t receiver) {
        return receivers.normals[receiver] == glm::vec3(0.0f) ? 2 : receiver < 700 ? 0 : 1;
    };
    EXPECT_TRUE(std::is_sorted(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return rank(a) < rank(b);
    }));
}

} // namespace
} // namespace relumine::prt
