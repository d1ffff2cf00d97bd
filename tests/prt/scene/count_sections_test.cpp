#include "prt/scene/count_sections.h"

#include <algorithm>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/own_folder.h"
#include "tests/prt/damaged_file.h"
#include "tests/prt/made_sections.h"

namespace relumine::prt {
namespace {

namespace fs = std::filesystem;

/// Counts of a last block that is not full, a last tile that is not full, and every value.
VisibleCounts random_counts() {
    VisibleCounts counts{.num_receivers = BlockSize * (3 * VisibleCounts::TileBlocks + 7) - 5,
                         .num_leaves = 150};
    std::mt19937_64 random(3);
    const std::size_t num_words = counts.num_blocks() * counts.words_per_block();
    for (std::size_t word = 0; word < num_words; ++word) {
        std::uint64_t bits = random();
        bits &= random(); // a quarter of all pairs
        counts.visible.push_back(bits & random());
        counts.mixed.push_back(bits & ~counts.visible.back());
    }
    constexpr std::uint64_t LastLeaves = (std::uint64_t{1} << 150 % 64) - 1;
    for (std::size_t block = 0; block < counts.num_blocks(); ++block) {
        const std::size_t last = counts.word(block, counts.words_per_block() - 1);
        counts.visible[last] &= LastLeaves;
        counts.mixed[last] &= LastLeaves;
    }
    std::size_t num_mixed = 0;
    for (const std::uint64_t bits : counts.mixed)
        num_mixed += static_cast<std::size_t>(std::popcount(bits));
    counts.counts.resize(num_mixed * BlockSize);
    std::generate(counts.counts.begin(), counts.counts.end(),
                  [&] { return static_cast<std::uint8_t>(random() % 17); });
    counts.index();
    return counts;
}

class CountSectionsTest : public tests::FolderTest {
protected:
    void SetUp() override {
        NewSections sections;
        add_counts(sections, counts_);
        write_sections(file_, sections);
        good_ = read_sections(file_);
    }

    VisibleCounts read(Sections sections) const {
        const SectionReader reader = scenes::reader_of(file_, std::move(sections));
        VisibleCounts counts{.num_receivers = counts_.num_receivers,
                             .num_leaves = counts_.num_leaves};
        read_counts(reader, counts);
        return counts;
    }
    void refused(const std::string& reason, const Sections& sections) const {
        scenes::expect_refused(file_, reason, [&] { static_cast<void>(read(sections)); });
    }

    const VisibleCounts counts_ = random_counts();
    fs::path file_ = folder_ / "counts.prt";
    Sections good_;
};

TEST_F(CountSectionsTest, EveryValueComesBack) {
    const VisibleCounts counts = read(good_);
    EXPECT_EQ(counts.visible, counts_.visible);
    EXPECT_EQ(counts.mixed, counts_.mixed);
    EXPECT_EQ(counts.mixed_before, counts_.mixed_before);
    EXPECT_EQ(counts.counts, counts_.counts);
    EXPECT_EQ(good_.at("count_codes").size(), counts_.counts.size() / 2);
}

TEST_F(CountSectionsTest, TilesAreReadAlone) {
    const std::size_t num_tiles = counts_.num_tiles();
    const SectionReader reader(file_);
    for (const std::vector<std::size_t>& tiles : std::vector<std::vector<std::size_t>>{
             {0}, {1, 3}, {0, 2}, {num_tiles - 1}, {0, 1, 2, 3}}) {
        std::vector<std::uint64_t> mixed;
        std::vector<std::uint8_t> entries;
        std::size_t num_own = 0;
        for (const std::size_t tile : tiles) {
            const std::size_t first = counts_.tile_begin(tile);
            const std::size_t last = counts_.tile_begin(tile + 1);
            num_own += std::min(last * BlockSize, counts_.num_receivers) - first * BlockSize;
            for (std::size_t word = first * counts_.words_per_block();
                 word < last * counts_.words_per_block(); ++word) {
                mixed.push_back(counts_.mixed[word]);
                const std::uint8_t* of_word = counts_.mixed_counts(word, 0);
                entries.insert(entries.end(), of_word,
                               of_word + BlockSize *
                                             static_cast<std::size_t>(std::popcount(mixed.back())));
            }
        }
        const VisibleCounts part = read_counts_of_tiles(reader, counts_, tiles, num_own);
        EXPECT_EQ(part.mixed, mixed);
        EXPECT_EQ(part.counts, entries);
    }
}

TEST_F(CountSectionsTest, EntriesOf14ThatAreNone) {
    const auto with_rare = [&](const std::vector<std::uint8_t>& bytes) {
        Sections sections = good_;
        sections["counts_14"] = bytes_of(bytes);
        return sections;
    };
    const auto other = static_cast<std::uint8_t>(
        std::find_if(counts_.counts.begin(), counts_.counts.end(),
                     [](std::uint8_t count) { return count != 14 && count != 16; }) -
        counts_.counts.begin());
    refused("'counts_14'", with_rare({other}));
    refused("'counts_14'", with_rare({0x80}));             // goes on behind the end
    refused("'counts_14'", with_rare({0xff, 0xff, 0x7f})); // behind the last entry
    refused("'counts_14'", with_rare(std::vector<std::uint8_t>(12, 0xff)));
    refused("'counts_14'", with_rare({0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x7f}));
    EXPECT_NO_THROW(static_cast<void>(read(with_rare({}))));
}

} // namespace
} // namespace relumine::prt
