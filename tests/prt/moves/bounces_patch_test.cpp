// Lists that lose and get places, and go back.
#include "prt/moves/bounces_patch.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace relumine::prt {
namespace {

/// So many lists of up to nine of a few places, some of them twice.
PlaceLists random_lists(std::size_t count, std::mt19937& random) {
    PlaceLists result;
    for (std::size_t i = 0; i < count; ++i) {
        std::vector<std::uint32_t> list(random() % 10);
        for (std::uint32_t& place : list)
            place = static_cast<std::uint32_t>(random() % 12);
        std::ranges::sort(list);
        result.append(list);
    }
    return result;
}

/// Some of the lists are those of others.
PlaceLists mixed(const PlaceLists& a, const PlaceLists& b, std::uint32_t part,
                 std::mt19937& random) {
    PlaceLists result;
    for (std::size_t i = 0; i < a.size(); ++i)
        result.append(random() % 4 < part ? b[i] : a[i]);
    return result;
}

TEST(ListsPatch, LeadsToOtherListsAndBack) {
    std::mt19937 random(4);
    for (int i = 0; i < 300; ++i) {
        const std::size_t count = random() % 40;
        const PlaceLists before = random_lists(count, random);
        const PlaceLists after = mixed(before, random_lists(count, random),
                                       static_cast<std::uint32_t>(random() % 5), random);
        ListsPatch patch = difference(before, after);
        EXPECT_TRUE(std::ranges::is_sorted(patch.lists));
        PlaceLists lists = before;
        exchange(lists, patch);
        ASSERT_EQ(lists, after);
        exchange(lists, patch);
        ASSERT_EQ(lists, before);
        exchange(lists, patch);
        ASSERT_EQ(lists, after);
    }
}

TEST(ListsPatch, HoldsWhatDiffersAlone) {
    PlaceLists before, after;
    before.append(std::vector<std::uint32_t>{1, 1, 5});
    before.append(std::vector<std::uint32_t>{2});
    after.append(std::vector<std::uint32_t>{1, 5, 7});
    after.append(std::vector<std::uint32_t>{2});
    const ListsPatch patch = difference(before, after);
    EXPECT_EQ(patch.lists, std::vector<std::uint32_t>{0});
    EXPECT_EQ(patch.removed.places, std::vector<std::uint32_t>{1});
    EXPECT_EQ(patch.added.places, std::vector<std::uint32_t>{7});
}

} // namespace
} // namespace relumine::prt
