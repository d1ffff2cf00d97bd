#include "relight/tile_words.h"

#include <bit>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "prt/clusters/lattice.h"
#include "tests/prt/every_target.h"
#include "tests/relight/relit_scene.h"

namespace relumine::relight {
namespace {

/// Whether all receivers of a block that count a cluster face all of a grid of directions in its
/// cell. In a cluster that the block sees whole, all count, whatever is above their horizons.
bool faces_all(const prt::Transfer& transfer, std::size_t block, std::size_t cluster) {
    constexpr int Steps = 4;
    const prt::Cell& cell = transfer.quadtree.leaves()[cluster];
    const std::size_t end = std::min((block + 1) * prt::BlockSize, transfer.num_receivers());
    for (std::size_t place = block * prt::BlockSize; place < end; ++place)
        for (int i = 0; transfer.counts.count(place, cluster) > 0 && i < (Steps + 1) * (Steps + 1);
             ++i) {
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

TEST(TileWords, SayWhichBlocksHaveWhatToDo) {
    const prt::Transfer& transfer = scenes::relit_scene().transfer;
    const prt::VisibleCounts& counts = transfer.counts;
    scenes::on_every_target([&] {
        const TileWords words = tile_words(transfer, block_normals(transfer.normals));
        ASSERT_EQ(words.words.size(), counts.num_tiles() * counts.words_per_block());
        std::size_t num_visible = 0, num_clamped = 0, num_unclamped = 0, num_across = 0;
        for (std::size_t block = 0; block < counts.num_blocks(); ++block)
            for (std::size_t w = 0; w < counts.words_per_block(); ++w) {
                const std::size_t tile = block / prt::VisibleCounts::TileBlocks;
                const std::size_t bit = block % prt::VisibleCounts::TileBlocks;
                const TileWord& of_tile = words.words[tile * counts.words_per_block() + w];
                const std::uint64_t visible = counts.visible[counts.word(block, w)];
                const std::uint64_t mixed = counts.mixed[counts.word(block, w)];
                const std::uint64_t visible_across = across(transfer, block, w, visible);
                const bool is_clamped =
                    visible_across != 0 || across(transfer, block, w, mixed) != 0;
                EXPECT_EQ(words.across_of(of_tile, bit), visible_across);
                EXPECT_EQ(of_tile.visible >> bit & 1u, (visible & ~visible_across) != 0 ? 1u : 0u);
                EXPECT_EQ(of_tile.clamped >> bit & 1u, is_clamped ? 1u : 0u);
                EXPECT_EQ(of_tile.unclamped >> bit & 1u, mixed != 0 && !is_clamped ? 1u : 0u);
                num_visible += of_tile.visible >> bit & 1u;
                num_clamped += is_clamped ? 1 : 0;
                num_unclamped += of_tile.unclamped >> bit & 1u;
                num_across += visible_across != 0 ? 1 : 0;
            }
        // The scene has all kinds, or the test would say little.
        EXPECT_GT(num_visible, 100u);
        EXPECT_GT(num_clamped, 100u);
        EXPECT_GT(num_unclamped, 100u);
        EXPECT_GT(num_across, 100u);
    });
}

} // namespace
} // namespace relumine::relight
