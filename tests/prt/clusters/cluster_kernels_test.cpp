#include "prt/clusters/cluster_kernels.h"

#include <algorithm>
#include <random>

#include <glm/geometric.hpp>
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
                // A float lane adds up at most 256 terms of one sign: 256 half-units of
                // 2^-24, 1.5e-5. The second term is for cells that are all equal, where only the
                // terms' own rounding is left.
                EXPECT_NEAR(sums[l], expected[l],
                            1.5e-5 * expected[l] + 1e-13 * static_cast<double>(num_receivers));
        }
    });
}

TEST(ClusterKernels, EqualSamplesHaveNoDistance) {
    scenes::on_every_target([] {
        std::mt19937 random(2);
        RandomCell cell(random, 300);
        cell.samples.directions.fill(cell.samples.directions[4]);
        cell.samples.lit.fill(cell.samples.lit[4]);
        for (const double sum : squared_distances(NormalArrays(cell.normals), cell.samples))
            EXPECT_LT(sum, 1e-13 * 300); // (half a unit in the last place)^2 per receiver, 2^-48
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

TEST(ClusterKernels, LeafColumnHoldsTheWeightedCounts) {
    std::mt19937 random(3);
    constexpr std::array<std::uint8_t, SamplesPerCell> CentreOnly = {0, 0, 0, 0, 16, 0, 0, 0, 0};
    for (const auto& weights : {SampleWeights, CentreOnly})
        for (const std::size_t num_receivers : {1u, 15u, 16u, 17u, 64u, 70u, 1024u, 1030u, 3000u}) {
            const RandomCell cell(random, num_receivers);
            const LeafColumn column = leaf_column(cell.samples, weights, num_receivers);
            std::size_t num_mixed = 0;
            for (std::size_t i = 0; i < num_receivers; ++i) {
                int expected = 0;
                for (std::size_t l = 0; l < SamplesPerCell; ++l)
                    expected += cell.lit(l, i) ? weights[l] : 0;
                ASSERT_EQ(count_in(column, i), expected)
                    << "receiver " << i << " of " << num_receivers;
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
    const LeafColumn column = leaf_column(samples, SampleWeights, 20);
    EXPECT_EQ(column.visible, std::vector<std::uint64_t>{0b11});
    EXPECT_EQ(column.mixed, std::vector<std::uint64_t>{0});
    EXPECT_TRUE(column.counts.empty());
}

} // namespace
} // namespace relumine::prt
