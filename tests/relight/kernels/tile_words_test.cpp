#include "relight/kernels/tile_words.h"

#include <bit>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "prt/clusters/lattice.h"
#include "tests/prt/every_target.h"
#include "tests/relight/relit_scene.h"

namespace relumine::relight {
namespace {

/// Whether all receivers of a block face all of a grid of directions in a cluster's cell.
bool faces_all(const prt::Transfer& transfer, std::size_t block, std::size_t cluster) {
    constexpr int Steps = 4;
    const prt::Cell& cell = transfer.quadtree.leaves()[cluster];
    const std::size_t end = std::min((block + 1) * prt::BlockSize, transfer.num_receivers());
    for (std::size_t place = block * prt::BlockSize; place < end; ++place)
        for (int i = 0; i < (Steps + 1) * (Steps + 1); ++i) {
            const double s = (cell.x + static_cast<double>(i % (Steps + 1)) / Steps) * cell.size();
            const double t = (cell.y + static_cast<double>(i / (Steps + 1)) / Steps) * cell.size();
            const glm::vec3 w(cubemap::direction(cell.face, s, t));
            if (glm::dot(transfer.normals[place], w) < -1e-6f)
                return false;
        }
    return true;
}

/// The clusters of a block and word that faces_all() does not hold for.
std::uint64_t across(const prt::Transfer& transfer, std::size_t block, std::size_t w,
                     std::uint64_t clusters) {
    std::uint64_t result = 0;
    for (; clusters != 0; clusters &= clusters - 1)
        if (!faces_all(transfer, block,
                       w * 64 + static_cast<std::size_t>(std::countr_zero(clusters))))
            result |= clusters & (~clusters + 1);
    return result;
}

/// How many words of a scene say what. A scene must have all kinds, or a test says little.
struct Kinds {
    std::size_t num_visible = 0, num_mixed = 0, num_across = 0, num_edges = 0, num_for_all = 0;
};

Kinds expect_true_words(const prt::Transfer& transfer) {
    const prt::VisibleCounts& counts = transfer.counts;
    Kinds kinds;
    scenes::on_every_target([&] {
        kinds = {};
        const TileWords words = tile_words(transfer, block_normals(transfer.normals));
        ASSERT_EQ(words.words.size(), counts.num_tiles() * counts.words_per_block());
        std::vector<TileWord> of_all_blocks(words.words.size(),
                                            {.whole_for_all = ~std::uint64_t{0}});
        for (std::size_t block = 0; block < counts.num_blocks(); ++block) {
            bool inside = false; // a run of visible clusters
            for (std::size_t w = 0; w < counts.words_per_block(); ++w) {
                const std::size_t tile = block / prt::VisibleCounts::TileBlocks;
                const std::size_t bit = block % prt::VisibleCounts::TileBlocks;
                const std::size_t word = tile * counts.words_per_block() + w;
                const TileWord& of_tile = words.words[word];
                const std::uint64_t visible = counts.visible[counts.word(block, w)];
                const std::uint64_t mixed = counts.mixed[counts.word(block, w)];
                const std::uint64_t visible_across = across(transfer, block, w, visible);
                const std::uint64_t above = visible & ~visible_across;
                bool any_edge = false;
                for (std::size_t i = 0; i < 64; ++i) {
                    any_edge |= inside != ((above >> i & 1u) != 0);
                    inside = (above >> i & 1u) != 0;
                }
                of_all_blocks[word].whole_for_all &= above;
                of_all_blocks[word].seen_by_some |= visible;
                of_all_blocks[word].mixed_for_some |= mixed;
                EXPECT_EQ(words.across_of(of_tile, bit), visible_across);
                EXPECT_EQ(of_tile.across >> bit & 1u, visible_across != 0 ? 1u : 0u);
                EXPECT_EQ(of_tile.visible >> bit & 1u, above != 0 ? 1u : 0u);
                EXPECT_EQ(of_tile.mixed >> bit & 1u, mixed != 0 ? 1u : 0u);
                EXPECT_EQ(of_tile.edges >> bit & 1u, any_edge ? 1u : 0u);
                kinds.num_visible += of_tile.visible >> bit & 1u;
                kinds.num_mixed += of_tile.mixed >> bit & 1u;
                kinds.num_across += of_tile.across >> bit & 1u;
                kinds.num_edges += of_tile.edges >> bit & 1u;
            }
        }
        for (std::size_t word = 0; word < words.words.size(); ++word) {
            EXPECT_EQ(words.words[word].whole_for_all, of_all_blocks[word].whole_for_all);
            EXPECT_EQ(words.words[word].seen_by_some, of_all_blocks[word].seen_by_some);
            EXPECT_EQ(words.words[word].mixed_for_some, of_all_blocks[word].mixed_for_some);
            kinds.num_for_all += words.words[word].whole_for_all != 0 ? 1 : 0;
        }
    });
    return kinds;
}

TEST(TileWords, SayWhichBlocksHaveWhatToDo) {
    const Kinds kinds = expect_true_words(scenes::relit_scene().transfer);
    EXPECT_GT(kinds.num_visible, kinds.num_edges);
    EXPECT_GT(kinds.num_mixed, 100u);
    EXPECT_GT(kinds.num_across, 100u);
    EXPECT_GT(kinds.num_edges, 100u);
}

TEST(TileWords, SayWhatAllBlocksOfATileSee) {
    EXPECT_GT(expect_true_words(scenes::relit_floor().transfer).num_for_all, 10u);
}

} // namespace
} // namespace relumine::relight
