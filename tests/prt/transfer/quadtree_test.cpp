#include "prt/transfer/quadtree.h"

#include <algorithm>
#include <random>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

std::vector<std::uint32_t> found(const Quadtree& tree, const FaceRectangle& rectangle) {
    std::vector<std::uint32_t> leaves;
    tree.find_leaves(rectangle, leaves);
    return leaves;
}

std::vector<std::uint32_t> found_by_looking_at_all(const Quadtree& tree, const FaceRectangle& r) {
    std::vector<std::uint32_t> leaves;
    for (std::uint32_t i = 0; i < tree.num_leaves(); ++i) {
        const Cell& cell = tree.leaves()[i];
        const double size = cell.size();
        const double width = std::min(r.s1, (cell.x + 1) * size) - std::max(r.s0, cell.x * size);
        const double height = std::min(r.t1, (cell.y + 1) * size) - std::max(r.t0, cell.y * size);
        if (cell.face == r.face && width > 0.0 && height > 0.0)
            leaves.push_back(i);
    }
    return leaves;
}

/// Flags of a tree whose first face goes down to `level` along its first children.
std::vector<bool> chain(std::uint32_t level) {
    std::vector<bool> flags(level, true);
    flags.resize(flags.size() + 1 + std::size_t{3} * level + 5, false);
    return flags;
}

TEST(Quadtree, WithoutSplitsEveryFaceIsALeaf) {
    const Quadtree tree;
    ASSERT_EQ(tree.num_leaves(), cubemap::NumFaces);
    for (std::size_t i = 0; i < tree.num_leaves(); ++i)
        EXPECT_EQ(tree.leaves()[i], Cell{.face = cubemap::AllFaces[i]});
}

TEST(Quadtree, LeavesTileEachFaceExactly) {
    std::mt19937 random(1);
    constexpr std::uint32_t MaxDepth = 6;
    for (int round = 0; round < 20; ++round) {
        const Quadtree tree(scenes::random_split_flags(random, MaxDepth, 0.6));
        constexpr std::size_t Side = std::size_t{1} << MaxDepth;
        std::vector<int> covered(cubemap::NumFaces * Side * Side, 0);
        std::vector<double> area(cubemap::NumFaces, 0.0);
        for (const Cell& cell : tree.leaves()) {
            area[static_cast<std::size_t>(cell.face)] += cell.size() * cell.size();
            const std::size_t n = Side >> cell.level;
            for (std::size_t y = cell.y * n; y < (cell.y + 1) * n; ++y)
                for (std::size_t x = cell.x * n; x < (cell.x + 1) * n; ++x)
                    ++covered[(static_cast<std::size_t>(cell.face) * Side + y) * Side + x];
        }
        EXPECT_THAT(area, testing::Each(1.0)); // dyadic areas add up without rounding
        EXPECT_THAT(covered, testing::Each(1));
    }
}

TEST(Quadtree, SplitFlagsRoundTrip) {
    std::mt19937 random(2);
    for (int round = 0; round < 50; ++round) {
        const std::vector<bool> flags = scenes::random_split_flags(random, 7, 0.5);
        const Quadtree tree(flags);
        EXPECT_EQ(tree.split_flags(), flags);
        // A full tree has three more leaves per split.
        const auto splits = static_cast<std::size_t>(std::count(flags.begin(), flags.end(), true));
        EXPECT_EQ(tree.num_leaves(), cubemap::NumFaces + 3 * splits);
        EXPECT_EQ(flags.size(), tree.num_leaves() + splits);
    }
}

TEST(Quadtree, ChildrenComeInReadingOrder) {
    std::vector<bool> flags = chain(1);
    const Quadtree tree(flags);
    ASSERT_EQ(tree.num_leaves(), 9u);
    for (std::uint32_t i = 0; i < 4; ++i)
        EXPECT_EQ(tree.leaves()[i],
                  (Cell{.face = cubemap::Face::PositiveX, .level = 1, .x = i % 2, .y = i / 2}));
}

TEST(Quadtree, RefusesBadFlags) {
    EXPECT_THROW(Quadtree(std::vector<bool>{}), std::invalid_argument);
    EXPECT_THROW(Quadtree(std::vector<bool>(5, false)), std::invalid_argument);
    EXPECT_THROW(Quadtree(std::vector<bool>(7, false)), std::invalid_argument);
    EXPECT_THROW(Quadtree(std::vector<bool>(6, true)), std::invalid_argument);
    EXPECT_THROW(Quadtree(std::vector<bool>(100000, true)), std::invalid_argument);
    std::mt19937 random(3);
    const std::vector<bool> flags = scenes::random_split_flags(random, 5, 0.6);
    for (std::size_t length = 0; length < flags.size(); ++length)
        EXPECT_THROW(Quadtree(std::vector<bool>(
                         flags.begin(), flags.begin() + static_cast<std::ptrdiff_t>(length))),
                     std::invalid_argument);
}

TEST(Quadtree, GoesDownToTheDeepestLevelAndNoFurther) {
    const Quadtree tree(chain(MaxLevel));
    EXPECT_EQ(tree.leaves()[0].level, MaxLevel);
    EXPECT_EQ(tree.split_flags(), chain(MaxLevel));
    EXPECT_THROW(Quadtree{chain(MaxLevel + 1)}, std::invalid_argument);
}

TEST(Quadtree, FindLeavesEqualsLookingAtAllLeaves) {
    std::mt19937 random(4);
    std::uniform_int_distribution<std::size_t> face(0, cubemap::NumFaces - 1);
    std::uniform_real_distribution<double> anywhere(-0.1, 1.1);
    for (int round = 0; round < 20; ++round) {
        const Quadtree tree(scenes::random_split_flags(random, 6, 0.6));
        for (int i = 0; i < 50; ++i) {
            const auto [s0, s1] = std::minmax({anywhere(random), anywhere(random)});
            const auto [t0, t1] = std::minmax({anywhere(random), anywhere(random)});
            const FaceRectangle rectangle{cubemap::AllFaces[face(random)], s0, t0, s1, t1};
            EXPECT_EQ(found(tree, rectangle), found_by_looking_at_all(tree, rectangle));
        }
    }
}

TEST(Quadtree, FindLeavesLeavesOutWhatOnlyTouches) {
    // Rectangles whose edges lie on cell boundaries: R = 16 is finer than some leaves and coarser
    // than others; R = 12 has boundaries that are no binary fractions beside some that are.
    std::mt19937 random(5);
    for (const std::uint32_t r : {16u, 12u}) {
        const Quadtree tree(scenes::random_split_flags(random, 6, 0.7));
        std::uniform_int_distribution<std::uint32_t> corner(0, r);
        for (int i = 0; i < 500; ++i) {
            const auto [x0, x1] = std::minmax({corner(random), corner(random)});
            const auto [y0, y1] = std::minmax({corner(random), corner(random)});
            const double n = r;
            const FaceRectangle rectangle{cubemap::Face::NegativeZ, x0 / n, y0 / n, x1 / n, y1 / n};
            const auto leaves = found(tree, rectangle);
            EXPECT_EQ(leaves, found_by_looking_at_all(tree, rectangle));
            if (x0 == x1 || y0 == y1) {
                EXPECT_TRUE(leaves.empty());
            }
        }
    }
}

TEST(Quadtree, ASubtreeOwnsARangeOfLeaves) {
    std::mt19937 random(6);
    const Quadtree tree(scenes::random_split_flags(random, 6, 0.7));
    for (std::uint32_t y = 0; y < 4; ++y)
        for (std::uint32_t x = 0; x < 4; ++x) {
            const auto leaves = found(
                tree, {cubemap::Face::PositiveY, x / 4.0, y / 4.0, (x + 1) / 4.0, (y + 1) / 4.0});
            ASSERT_FALSE(leaves.empty());
            EXPECT_EQ(leaves.back() - leaves.front() + 1, leaves.size());
        }
}

TEST(Quadtree, LeafAtAPointIsTheOneWhoseCellHoldsIt) {
    std::mt19937 random(7);
    const Quadtree tree(scenes::random_split_flags(random, 6, 0.7));
    std::uniform_real_distribution<double> coordinate(0.0, 1.0);
    for (const cubemap::Face face : cubemap::AllFaces)
        for (int i = 0; i < 200; ++i) {
            const double s = i == 0 ? 0.0 : i == 1 ? 1.0 : i == 2 ? 0.5 : coordinate(random);
            const double t = i == 0 ? 1.0 : i == 1 ? 0.0 : i == 2 ? 0.5 : coordinate(random);
            const Cell& cell = tree.leaves()[tree.leaf_at({face, s, t})];
            EXPECT_EQ(cell.face, face);
            EXPECT_LE(cell.x * cell.size(), s);
            EXPECT_GE((cell.x + 1) * cell.size(), s);
            EXPECT_LE(cell.y * cell.size(), t);
            EXPECT_GE((cell.y + 1) * cell.size(), t);
        }
}

TEST(Quadtree, FindLeavesAppends) {
    std::vector<std::uint32_t> leaves = {77};
    Quadtree().find_leaves({.face = cubemap::Face::NegativeY}, leaves);
    EXPECT_EQ(leaves, (std::vector<std::uint32_t>{77, 3}));
}

} // namespace
} // namespace relumine::prt
