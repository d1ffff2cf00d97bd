#include "prt/transfer/visible_counts.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "prt/clusters/column_store.h"

namespace relumine::prt {
namespace {

/// [leaf][receiver]
using Table = std::vector<std::vector<std::uint8_t>>;

/// Blocks of all, of nothing and of anything.
Table random_table(std::mt19937& random, std::size_t num_receivers, std::size_t num_leaves) {
    std::uniform_int_distribution<int> kind(0, 3);
    std::uniform_int_distribution<int> count(0, 16);
    Table table(num_leaves, std::vector<std::uint8_t>(num_receivers));
    for (auto& leaf : table)
        for (std::size_t begin = 0; begin < num_receivers; begin += BlockSize) {
            const int k = kind(random);
            for (std::size_t i = begin; i < std::min(begin + BlockSize, num_receivers); ++i)
                leaf[i] = static_cast<std::uint8_t>(k == 0 ? 0 : k == 1 ? 16 : count(random));
        }
    return table;
}

LeafColumn column_of(const std::vector<std::uint8_t>& leaf) {
    const std::size_t num_blocks = (leaf.size() + BlockSize - 1) / BlockSize;
    LeafColumn column;
    column.visible.resize((num_blocks + 63) / 64);
    column.mixed.resize((num_blocks + 63) / 64);
    for (std::size_t block = 0; block < num_blocks; ++block) {
        const std::size_t end = std::min((block + 1) * BlockSize, leaf.size());
        bool any = false, all = true;
        for (std::size_t i = block * BlockSize; i < end; ++i) {
            any = any || leaf[i] > 0;
            all = all && leaf[i] == 16;
        }
        if (!any)
            continue;
        (all ? column.visible : column.mixed)[block / 64] |= std::uint64_t{1} << (block % 64);
        for (std::size_t i = block * BlockSize; !all && i < (block + 1) * BlockSize; ++i)
            column.counts.push_back(i < leaf.size() ? leaf[i] : std::uint8_t{0});
    }
    return column;
}

VisibleCounts counts_of(const Table& table, std::size_t num_receivers) {
    ColumnStore columns(num_receivers);
    std::vector<std::uint32_t> order;
    // Columns come in another order than leaves.
    for (std::size_t i = table.size(); i-- > 0;) {
        columns.add(column_of(table[i]));
        order.push_back(static_cast<std::uint32_t>(i));
    }
    return columns.take(order);
}

TEST(VisibleCounts, CountEqualsAPlainTable) {
    std::mt19937 random(1);
    // Around the sizes of a block (16 receivers), a word of leaves (64) and a word of a column (64
    // blocks).
    for (const std::size_t num_receivers : {1u, 15u, 16u, 17u, 100u, 1023u, 1024u, 1025u, 1100u})
        for (const std::size_t num_leaves : {6u, 63u, 64u, 65u, 130u}) {
            const Table table = random_table(random, num_receivers, num_leaves);
            const VisibleCounts counts = counts_of(table, num_receivers);
            ASSERT_EQ(counts.num_receivers, num_receivers);
            ASSERT_EQ(counts.num_leaves, num_leaves);
            for (std::size_t leaf = 0; leaf < num_leaves; ++leaf)
                for (std::size_t receiver = 0; receiver < num_receivers; ++receiver)
                    ASSERT_EQ(counts.count(receiver, leaf), table[leaf][receiver])
                        << "receiver " << receiver << " of " << num_receivers << ", leaf " << leaf
                        << " of " << num_leaves;
        }
}

TEST(VisibleCounts, ColumnsComeBackAsTheyWere) {
    std::mt19937 random(5);
    // Of one run of receivers, and of three.
    for (const std::size_t num_receivers : {100u, 33000u}) {
        const Table table = random_table(random, num_receivers, 20);
        ColumnStore columns(num_receivers);
        for (const auto& leaf : table)
            columns.add(column_of(leaf));
        for (std::size_t i = 0; i < table.size(); ++i) {
            const LeafColumn expected = column_of(table[i]);
            LeafColumn column;
            for (std::size_t tile = 0; tile < columns.num_tiles(); ++tile) {
                const TileColumn of_tile = columns.tile(i, tile);
                column.visible.push_back(of_tile.visible);
                column.mixed.push_back(of_tile.mixed);
                column.counts.insert(column.counts.end(), of_tile.counts.begin(),
                                     of_tile.counts.end());
            }
            EXPECT_EQ(column.visible, expected.visible);
            EXPECT_EQ(column.mixed, expected.mixed);
            EXPECT_EQ(column.counts, expected.counts);
        }
        const VisibleCounts counts = counts_of(table, num_receivers);
        for (std::size_t leaf = 0; leaf < table.size(); ++leaf)
            for (std::size_t receiver = 0; receiver < num_receivers; ++receiver)
                ASSERT_EQ(counts.count(receiver, leaf), table[leaf][receiver]);
    }
}

TEST(VisibleCounts, TilesThenWordsThenBlocksThenLeaves) {
    std::mt19937 random(2);
    constexpr std::size_t NumReceivers = 66 * BlockSize; // a tile of 64 blocks and one of two
    const Table table = random_table(random, NumReceivers, 130);
    const VisibleCounts counts = counts_of(table, NumReceivers);
    std::vector<std::uint8_t> expected;
    std::size_t word = 0;
    for (const auto& [begin, end] : {std::pair{0u, 64u}, std::pair{64u, 66u}})
        for (std::size_t first_leaf = 0; first_leaf < table.size(); first_leaf += 64)
            for (std::size_t block = begin; block < end; ++block) {
                EXPECT_EQ(counts.word(block, first_leaf / 64), word++);
                for (std::size_t leaf = first_leaf; leaf < std::min(first_leaf + 64, table.size());
                     ++leaf)
                    if ((column_of(table[leaf]).mixed[block / 64] >> (block % 64) & 1u) != 0)
                        expected.insert(expected.end(), &table[leaf][block * BlockSize],
                                        &table[leaf][block * BlockSize] + BlockSize);
            }
    EXPECT_EQ(counts.counts, expected);
}

TEST(VisibleCounts, IndexRestoresWhatIsNotStored) {
    std::mt19937 random(3);
    const VisibleCounts counts = counts_of(random_table(random, 200, 100), 200);
    VisibleCounts again = counts;
    again.mixed_before.clear();
    again.index();
    EXPECT_EQ(again.mixed_before, counts.mixed_before);
}

TEST(VisibleCounts, IndexAddsUpAcrossItsParts) {
    // More words than one thread adds up at once.
    std::mt19937_64 random(5);
    VisibleCounts counts{.num_receivers = 50'000 * BlockSize, .num_leaves = 64};
    counts.visible.resize(50'000);
    std::vector<std::uint64_t> expected;
    std::uint64_t num_pairs = 0;
    for (std::size_t word = 0; word < counts.visible.size(); ++word) {
        expected.push_back(num_pairs);
        const std::uint64_t some = random(), others = random();
        counts.mixed.push_back(some & others);
        counts.visible[word] = random() & ~counts.mixed[word];
        num_pairs += static_cast<std::uint64_t>(std::popcount(counts.mixed[word]));
    }
    counts.counts.assign(num_pairs * BlockSize, 3);
    counts.index();
    EXPECT_EQ(counts.mixed_before, expected);
    for (const std::size_t at :
         {std::size_t{0}, counts.counts.size() / 2, counts.counts.size() - 1}) {
        VisibleCounts bad = counts;
        bad.counts[at] = 17;
        EXPECT_THROW(bad.index(), std::invalid_argument);
    }
    for (const std::size_t word : {std::size_t{0}, std::size_t{49'999}}) {
        VisibleCounts bad = counts;
        bad.visible[word] |= bad.mixed[word];
        EXPECT_THROW(bad.index(), std::invalid_argument);
    }
}

TEST(VisibleCounts, IndexRefusesContradictions) {
    std::mt19937 random(4);
    const VisibleCounts good = counts_of(random_table(random, 100, 70), 100);
    const auto refused = [&](const char* what, const std::function<void(VisibleCounts&)>& damage) {
        VisibleCounts bad = good;
        damage(bad);
        EXPECT_THROW(bad.index(), std::invalid_argument) << what;
    };
    refused("visible too short", [](VisibleCounts& c) { c.visible.pop_back(); });
    refused("mixed too short", [](VisibleCounts& c) { c.mixed.pop_back(); });
    refused("visible too long", [](VisibleCounts& c) { c.visible.push_back(0); });
    refused("no bits", [](VisibleCounts& c) { c.visible.clear(), c.mixed.clear(); });
    refused("half a block", [](VisibleCounts& c) { c.counts.pop_back(); });
    refused("a block missing",
            [](VisibleCounts& c) { c.counts.resize(c.counts.size() - BlockSize); });
    refused("a block too many",
            [](VisibleCounts& c) { c.counts.resize(c.counts.size() + BlockSize); });
    refused("count of 17", [](VisibleCounts& c) { c.counts[c.counts.size() / 2] = 17; });
    refused("count of 255", [](VisibleCounts& c) { c.counts.back() = 255; });
    refused("both classes", [](VisibleCounts& c) { c.visible[0] |= c.mixed[0]; });
    refused("visible beyond the last leaf",
            [](VisibleCounts& c) { c.visible[c.word(0, 1)] |= std::uint64_t{1} << 6; });
    refused("mixed beyond the last leaf", [](VisibleCounts& c) {
        c.mixed.back() |= std::uint64_t{1} << 63;
        c.counts.resize(c.counts.size() + BlockSize);
    });
    refused("more receivers", [](VisibleCounts& c) { c.num_receivers += BlockSize; });
    refused("more leaves", [](VisibleCounts& c) { c.num_leaves += 64; });
    refused("fewer leaves", [](VisibleCounts& c) { c.num_leaves = 6; });
}

TEST(VisibleCounts, NothingToCount) {
    VisibleCounts counts;
    counts.index();
    EXPECT_EQ(counts.num_blocks(), 0u);
    EXPECT_EQ(counts.num_mixed(), 0u);
}

} // namespace
} // namespace relumine::prt
