#include "prt/clusters/shadow_edges.h"

#include <gtest/gtest.h>

namespace relumine::prt {
namespace {

TEST(ShadowEdges, KnowTheCornersOfOneCell) {
    const ShadowEdges edges;
    EXPECT_EQ(edges.corner(0), 0.0f);
    EXPECT_EQ(edges.corner(16), 1.0f);
    // One of four corners is dark; two of four are where a line leaves half.
    EXPECT_NEAR(edges.corner(15), 0.75f, 1e-3f);
    EXPECT_NEAR(edges.corner(1), 0.25f, 1e-3f);
    for (std::size_t count = 0; count <= 16; ++count)
        EXPECT_NEAR(edges.corner(count) + edges.corner(16 - count), 1.0f, 0.02f) << count;
}

TEST(ShadowEdges, FindTheDarkCornerByTheNeighbours) {
    const ShadowEdges edges;
    // The third child, at the lower left, has one dark sixteenth, and all others are lit.
    const ShadowEdges::Chances* const corner = edges.samples({16, 16, 15, 16});
    ASSERT_NE(corner, nullptr);
    for (std::size_t l = 0; l < SamplesPerCell; ++l)
        EXPECT_EQ((*corner)[l], l == 6 ? 0.0f : 1.0f) << l;
    // The lower row is dark: a horizontal edge.
    const ShadowEdges::Chances* const row = edges.samples({16, 16, 12, 12});
    ASSERT_NE(row, nullptr);
    for (std::size_t l = 0; l < SamplesPerCell; ++l)
        EXPECT_EQ((*row)[l], l >= 6 ? 0.0f : 1.0f) << l;
}

TEST(ShadowEdges, AreStraight) {
    const ShadowEdges edges;
    EXPECT_EQ(edges.samples({16, 0, 0, 16}), nullptr);
    EXPECT_EQ(edges.samples({15, 15, 15, 15}), nullptr);
    ASSERT_NE(edges.samples({0, 0, 0, 0}), nullptr);
    ASSERT_NE(edges.samples({16, 16, 16, 16}), nullptr);
}

} // namespace
} // namespace relumine::prt
