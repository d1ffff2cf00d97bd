#include "prt/transfer/cell_index.h"

#include <set>

#include <gtest/gtest.h>

namespace relumine::prt {
namespace {

TEST(CellIndex, NumbersAllCellsOfAllLevelsOnce) {
    std::set<std::uint32_t> seen;
    std::uint32_t count = 0;
    for (std::uint8_t level = 0; level <= 3; ++level)
        for (const cubemap::Face face : cubemap::AllFaces)
            for (std::uint32_t y = 0; y < 1u << level; ++y)
                for (std::uint32_t x = 0; x < 1u << level; ++x) {
                    const std::uint32_t index = cell_index({face, level, x, y});
                    EXPECT_EQ(level_of_index(index), level);
                    seen.insert(index);
                    ++count;
                }
    EXPECT_EQ(seen.size(), count);
    EXPECT_EQ(*seen.rbegin(), count - 1);
    EXPECT_EQ(num_cells_above(4), count);
}

TEST(CellIndex, ChildrenFollowEachOther) {
    const Cell cell{cubemap::Face::NegativeZ, 5, 19, 7};
    for (std::uint32_t i = 0; i < 4; ++i)
        EXPECT_EQ(place_in_level(cell.child(i)), 4 * place_in_level(cell) + i);
}

TEST(CellIndex, TheDeepestLevelFits) {
    const std::uint32_t last = (1u << MaxLevel) - 1;
    const std::uint32_t index = cell_index({cubemap::Face::NegativeZ, MaxLevel, last, last});
    EXPECT_EQ(std::uint64_t{index} + 1, 2 * ((std::uint64_t{1} << 2 * (MaxLevel + 1)) - 1));
    EXPECT_EQ(level_of_index(index), MaxLevel);
}

} // namespace
} // namespace relumine::prt
