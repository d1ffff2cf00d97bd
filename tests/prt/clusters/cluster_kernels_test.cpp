#include "prt/clusters/cluster_kernels.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "prt/clusters/lattice.h"
#include "tests/prt/every_target.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

/// Random receivers around one random cell, with planes that hold what is above the horizon and (at
/// random) not blocked.
struct RandomCell {
    std::vector<glm::vec3> normals;
    std::array<std::vector<std::uint64_t>, SamplesPerCell> planes;
    CellSamples samples;

    RandomCell(std::mt19937& random, std::size_t num_receivers) {
        std::uniform_int_distribution<std::uint32_t> place(0, 7);
        const Cell cell{
            .face = cubemap::Face::PositiveZ, .level = 3, .x = place(random), .y = place(random)};
        const auto points = lattice_points(cell);
        std::bernoulli_distribution zero(0.05);
        for (std::size_t i = 0; i < num_receivers; ++i)
            normals.push_back(zero(random) ? glm::vec3(0.0f) : scenes::random_direction(random));
        std::uniform_int_distribution<int> kind(0, 3);
        const std::size_t num_words = (num_receivers + WordSize - 1) / WordSize;
        for (std::vector<std::uint64_t>& plane : planes)
            plane.resize(num_words);
        for (std::size_t word = 0; word < num_words; ++word) {
            const int k = kind(random); // no light at all, all light, any
            for (std::size_t l = 0; l < SamplesPerCell; ++l) {
                const glm::vec3 w = direction(points[l]);
                for (std::size_t i = word * WordSize;
                     i < std::min((word + 1) * WordSize, num_receivers); ++i)
                    if (glm::dot(normals[i], w) > 0.0f && k > 0 && (k == 1 || random() % 2 == 0))
                        planes[l][word] |= std::uint64_t{1} << (i % WordSize);
            }
        }
        for (std::size_t l = 0; l < SamplesPerCell; ++l) {
            samples.directions[l] = direction(points[l]);
            samples.lit[l] = planes[l].data();
        }
    }

    [[nodiscard]] bool is_above(std::size_t sample, std::size_t receiver) const {
        return glm::dot(normals[receiver], samples.directions[sample]) > 0.0f;
    }
    [[nodiscard]] bool lit(std::size_t sample, std::size_t receiver) const {
        return (planes[sample][receiver / WordSize] >> (receiver % WordSize) & 1u) != 0;
    }
};

std::array<double, SamplesPerCell> plain_squared_distances(const RandomCell& cell) {
    std::array<double, SamplesPerCell> sums{};
    for (std::size_t i = 0; i < cell.normals.size(); ++i) {
        std::array<double, SamplesPerCell> transfer{};
        double mean = 0.0;
        for (std::size_t l = 0; l < SamplesPerCell; ++l) {
            if (cell.lit(l, i))
                transfer[l] =
                    glm::dot(glm::dvec3(cell.normals[i]), glm::dvec3(cell.samples.directions[l]));
            mean += transfer[l] * SampleWeights[l] / FullCount;
        }
        for (std::size_t l = 0; l < SamplesPerCell; ++l)
            sums[l] += (transfer[l] - mean) * (transfer[l] - mean);
    }
    return sums;
}

TEST(ClusterKernels, SquaredDistancesEqualPlainSumsOnEveryTarget) {
    scenes::on_every_target([] {
        std::mt19937 random(1);
        for (const std::size_t num_receivers :
             {1u, 16u, 63u, 64u, 65u, 1000u, 1024u, 1025u, 5000u}) {
            const RandomCell cell(random, num_receivers);
            const NormalArrays normals(cell.normals);
            const auto sums = squared_distances(normals, cell.samples);
            const auto expected = plain_squared_distances(cell);
            for (std::size_t l = 0; l < SamplesPerCell; ++l)
                // Besides, half a unit a run. A float lane adds up at most 256 terms of one sign:
                // 256 half-units of 2^-24, 1.5e-5. The second term is for cells that are all equal,
                // where only the terms' own rounding is left.
                EXPECT_NEAR(static_cast<double>(sums[l]) * SquaredDistanceUnit, expected[l],
                            1.5e-5 * expected[l] + 1e-13 * static_cast<double>(num_receivers) +
                                3.0 * SquaredDistanceUnit);
        }
    });
}

TEST(ClusterKernels, EqualSamplesHaveNoDistance) {
    scenes::on_every_target([] {
        std::mt19937 random(2);
        RandomCell cell(random, 300);
        cell.samples.directions.fill(cell.samples.directions[4]);
        cell.samples.lit.fill(cell.samples.lit[4]);
        for (const std::int64_t sum : squared_distances(NormalArrays(cell.normals), cell.samples))
            EXPECT_EQ(sum, 0); // (half a unit in the last place)^2 per receiver, 2^-48
    });
}

TEST(ClusterKernels, NormalsArePaddedToWholeWordsWithZeros) {
    const NormalArrays normals(std::vector<glm::vec3>(65, glm::vec3(1.0f, 2.0f, 3.0f)));
    EXPECT_EQ(normals.num_words(), 2u);
    ASSERT_EQ(normals.x.size(), 128u);
    EXPECT_EQ(normals.y[64], 2.0f);
    for (std::size_t i = 65; i < 128; ++i)
        EXPECT_EQ(glm::vec3(normals.x[i], normals.y[i], normals.z[i]), glm::vec3(0.0f));
    EXPECT_EQ(NormalArrays(std::vector<glm::vec3>{}).num_words(), 0u);
}

/// What the column says of one receiver.
int count_in(const LeafColumn& column, std::size_t receiver) {
    const std::size_t block = receiver / BlockSize;
    const auto bit = [&](const std::vector<std::uint64_t>& words, std::size_t b) {
        return (words[b / 64] >> (b % 64) & 1u) != 0;
    };
    if (bit(column.visible, block))
        return 16;
    if (!bit(column.mixed, block))
        return 0;
    std::size_t before = 0;
    for (std::size_t b = 0; b < block; ++b)
        before += bit(column.mixed, b) ? 1 : 0;
    return column.counts[before * BlockSize + receiver % BlockSize];
}

TEST(ClusterKernels, LeafColumnHoldsTheVisiblePartOfWhatIsAboveTheHorizon) {
    std::mt19937 random(3);
    for (const auto& weights : {SampleWeights, CentreWeights})
        for (const std::size_t num_receivers : {1u, 15u, 16u, 17u, 64u, 70u, 1024u, 1030u, 3000u}) {
            const RandomCell cell(random, num_receivers);
            const LeafColumn column =
                leaf_column(NormalArrays(cell.normals), cell.samples, weights, num_receivers);
            std::size_t num_mixed = 0;
            for (std::size_t i = 0; i < num_receivers; ++i) {
                int lit = 0, above = 0;
                for (std::size_t l = 0; l < SamplesPerCell; ++l) {
                    lit += cell.lit(l, i) ? weights[l] : 0;
                    above += cell.is_above(l, i) ? weights[l] : 0;
                }
                if (above != 0) {
                    ASSERT_EQ(count_in(column, i), std::lround(16.0 * lit / above))
                        << "receiver " << i << " of " << num_receivers;
                } else { // takes what the others of its block have
                    ASSERT_THAT(count_in(column, i), testing::AnyOf(0, 16));
                }
            }
            for (const std::uint64_t word : column.mixed)
                num_mixed += static_cast<std::size_t>(std::popcount(word));
            EXPECT_EQ(column.counts.size(), num_mixed * BlockSize);
            for (std::size_t i = 0; i < column.visible.size(); ++i)
                EXPECT_EQ(column.visible[i] & column.mixed[i], 0u);
        }
}

TEST(ClusterKernels, ABlockThatEndsEarlyCanBeAllVisible) {
    std::vector<std::uint64_t> plane = {(std::uint64_t{1} << 20) - 1};
    CellSamples samples;
    samples.lit.fill(plane.data());
    samples.directions.fill(glm::vec3(0.0f, 1.0f, 0.0f));
    const NormalArrays normals(std::vector<glm::vec3>(20, glm::vec3(0.0f, 1.0f, 0.0f)));
    const LeafColumn column = leaf_column(normals, samples, SampleWeights, 20);
    EXPECT_EQ(column.visible, std::vector<std::uint64_t>{0b11});
    EXPECT_EQ(column.mixed, std::vector<std::uint64_t>{0});
    EXPECT_TRUE(column.counts.empty());
}

TEST(ClusterKernels, HorizonsAloneNeverMixABlock) {
    std::mt19937 random(4);
    constexpr std::size_t NumReceivers = 500;
    const RandomCell random_cell(random, NumReceivers);
    // Every sample above the horizon is lit.
    std::array<std::vector<std::uint64_t>, SamplesPerCell> planes;
    CellSamples samples = random_cell.samples;
    for (std::size_t l = 0; l < SamplesPerCell; ++l) {
        planes[l].resize((NumReceivers + WordSize - 1) / WordSize);
        for (std::size_t i = 0; i < NumReceivers; ++i)
            if (random_cell.is_above(l, i))
                planes[l][i / WordSize] |= std::uint64_t{1} << (i % WordSize);
        samples.lit[l] = planes[l].data();
    }
    const LeafColumn column =
        leaf_column(NormalArrays(random_cell.normals), samples, SampleWeights, NumReceivers);
    EXPECT_TRUE(column.counts.empty());
    // One receiver that sees nothing of what it has above its horizon mixes its block. The others
    // of the block keep all or, without anything above their horizons, count nothing.
    const auto sees_all = [&](std::size_t i) {
        for (std::size_t l = 0; l < SamplesPerCell; ++l)
            if (!random_cell.is_above(l, i))
                return false;
        return true;
    };
    std::size_t first = 0;
    while (!sees_all(first) || !sees_all(first + 1) || first / BlockSize != (first + 1) / BlockSize)
        ++first;
    for (std::vector<std::uint64_t>& plane : planes)
        plane[first / WordSize] &= ~(std::uint64_t{1} << (first % WordSize));
    const LeafColumn mixed =
        leaf_column(NormalArrays(random_cell.normals), samples, SampleWeights, NumReceivers);
    ASSERT_EQ(mixed.counts.size(), BlockSize);
    for (std::size_t i = first / BlockSize * BlockSize; i < (first / BlockSize + 1) * BlockSize;
         ++i) {
        bool any = false;
        for (std::size_t l = 0; l < SamplesPerCell; ++l)
            any = any || random_cell.is_above(l, i);
        EXPECT_EQ(mixed.counts[i % BlockSize], any && i != first ? 16 : 0);
    }
}

} // namespace
} // namespace relumine::prt
