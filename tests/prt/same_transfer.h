// Two transfers that must be the same bit by bit.
#pragma once

#include <gtest/gtest.h>

#include "prt/transfer/transfer.h"

namespace relumine::prt {

inline void expect_same(const Transfer& a, const Transfer& b) {
    ASSERT_EQ(a.quadtree.split_flags(), b.quadtree.split_flags());
    EXPECT_EQ(a.order, b.order);
    EXPECT_EQ(a.normals, b.normals);
    EXPECT_EQ(a.counts.visible, b.counts.visible);
    EXPECT_EQ(a.counts.mixed, b.counts.mixed);
    EXPECT_EQ(a.counts.mixed_before, b.counts.mixed_before);
    EXPECT_EQ(a.counts.counts, b.counts.counts);
}

} // namespace relumine::prt
