#include "prt/clusters/lattice.h"

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace relumine::prt {
namespace {

std::vector<Cell> all_cells(std::uint32_t level) {
    std::vector<Cell> cells;
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < 1u << level; ++y)
            for (std::uint32_t x = 0; x < 1u << level; ++x)
                cells.push_back(
                    {.face = face, .level = static_cast<std::uint8_t>(level), .x = x, .y = y});
    return cells;
}

Cell random_cell(std::mt19937& random, std::uint32_t level) {
    std::uniform_int_distribution<std::uint32_t> face(0, cubemap::NumFaces - 1);
    std::uniform_int_distribution<std::uint32_t> place(0, (1u << level) - 1);
    return {.face = cubemap::AllFaces[face(random)],
            .level = static_cast<std::uint8_t>(level),
            .x = place(random),
            .y = place(random)};
}

// A cube whose edges are cut into n parts has 6 n^2 + 2 grid points, so any point with two names,
// on a face's edge say, or any two points with one name would show.
TEST(Lattice, CellsShareTheirPointsOverEdgesAndCornersOfTheCube) {
    for (std::uint32_t level = 0; level <= 5; ++level) {
        std::set<LatticePoint> points;
        for (const Cell& cell : all_cells(level))
            for (const LatticePoint point : lattice_points(cell))
                points.insert(point);
        const std::size_t n = std::size_t{2} << level;
        EXPECT_EQ(points.size(), 6 * n * n + 2) << "level " << level;
    }
}

TEST(Lattice, CornersOfTheCubeBelongToThreeFacesAndItsEdgesToTwo) {
    std::map<LatticePoint, int> faces;
    for (const Cell& cell : all_cells(0))
        for (const LatticePoint point : lattice_points(cell))
            ++faces[point];
    const auto with = [&](int n) {
        return std::count_if(faces.begin(), faces.end(),
                             [n](const auto& entry) { return entry.second == n; });
    };
    EXPECT_EQ(with(3), 8);
    EXPECT_EQ(with(2), 12);
    EXPECT_EQ(with(1), 6);
}

TEST(Lattice, ASplitAddsExactlySixteenPoints) {
    std::mt19937 random(1);
    for (std::uint32_t level = 0; level < MaxLevel; ++level) {
        const Cell cell = random_cell(random, level);
        const auto own = lattice_points(cell);
        std::set<LatticePoint> points(own.begin(), own.end());
        EXPECT_EQ(points.size(), SamplesPerCell);
        for (std::uint32_t i = 0; i < 4; ++i)
            for (const LatticePoint point : lattice_points(cell.child(i)))
                points.insert(point);
        EXPECT_EQ(points.size(), 25u) << "level " << level;
    }
}

TEST(Lattice, NamesOfOneLevelAreTheNamesOfTheNext) {
    // Sample i of a cell is a corner of the children that meet there.
    std::mt19937 random(2);
    for (std::uint32_t level = 0; level < MaxLevel; ++level) {
        const Cell cell = random_cell(random, level);
        const auto points = lattice_points(cell);
        EXPECT_EQ(lattice_points(cell.child(0))[0], points[0]);
        EXPECT_EQ(lattice_points(cell.child(0))[8], points[4]);
        EXPECT_EQ(lattice_points(cell.child(1))[0], points[1]);
        EXPECT_EQ(lattice_points(cell.child(2))[0], points[3]);
        EXPECT_EQ(lattice_points(cell.child(3))[0], points[4]);
        EXPECT_EQ(lattice_points(cell.child(3))[8], points[8]);
    }
}

TEST(Lattice, DirectionIsThatOfTheNamedPointExactly) {
    std::mt19937 random(3);
    for (int round = 0; round < 1000; ++round) {
        const Cell cell = random_cell(random, static_cast<std::uint32_t>(round) % (MaxLevel + 1));
        const auto points = lattice_points(cell);
        for (std::uint32_t i = 0; i < SamplesPerCell; ++i) {
            const std::uint32_t column = i % 3, row = i / 3;
            const double s = (cell.x + 0.5 * column) * cell.size();
            const double t = (cell.y + 0.5 * row) * cell.size();
            EXPECT_EQ(direction(points[i]), glm::vec3(cubemap::direction(cell.face, s, t)));
        }
    }
}

TEST(Lattice, WeightsAreTheTrapezoidRule) {
    int sum = 0;
    for (const std::uint8_t weight : SampleWeights)
        sum += weight;
    EXPECT_EQ(sum, FullCount);
    // Exact for what is linear along both axes: the mean of s t over [0, 1]^2 is 1/4.
    double mean = 0.0;
    for (std::size_t i = 0; i < SamplesPerCell; ++i) {
        const std::size_t column = i % 3, row = i / 3;
        mean +=
            SampleWeights[i] * 0.5 * static_cast<double>(column) * 0.5 * static_cast<double>(row);
    }
    EXPECT_EQ(mean / FullCount, 0.25);
}

} // namespace
} // namespace relumine::prt
