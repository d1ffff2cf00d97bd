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
/// cell.
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

/// The plain form: one block and word at a time.
TileWord plain_bits(const prt::Transfer& transfer, std::size_t block, std::size_t w) {
    const std::size_t word = transfer.counts.word(block, w);
    bool unclamped = true;
    for (std::uint64_t mixed = transfer.counts.mixed[word]; mixed != 0; mixed &= mixed - 1)
        unclamped =
            unclamped &&
            faces_all(transfer, block, w * 64 + static_cast<std::size_t>(std::countr_zero(mixed)));
    const bool any = transfer.counts.mixed[word] != 0;
    return {.visible = transfer.counts.visible[word] != 0 ? 1u : 0u,
            .clamped = any && !unclamped ? 1u : 0u,
            .unclamped = any && unclamped ? 1u : 0u};
}

TEST(TileWords, SayWhichBlocksHaveWhatToDo) {
    const prt::Transfer& transfer = scenes::relit_scene().transfer;
    const prt::VisibleCounts& counts = transfer.counts;
    scenes::on_every_target([&] {
        const std::vector<TileWord> words = tile_words(transfer, block_normals(transfer.normals));
        ASSERT_EQ(words.size(), counts.num_tiles() * counts.words_per_block());
        std::size_t num_visible = 0, num_clamped = 0, num_unclamped = 0;
        for (std::size_t block = 0; block < counts.num_blocks(); ++block)
            for (std::size_t w = 0; w < counts.words_per_block(); ++w) {
                const std::size_t tile = block / prt::VisibleCounts::TileBlocks;
                const std::size_t bit = block % prt::VisibleCounts::TileBlocks;
                const TileWord& of_tile = words[tile * counts.words_per_block() + w];
                const TileWord plain = plain_bits(transfer, block, w);
                EXPECT_EQ(of_tile.visible >> bit & 1u, plain.visible);
                EXPECT_EQ(of_tile.clamped >> bit & 1u, plain.clamped);
                EXPECT_EQ(of_tile.unclamped >> bit & 1u, plain.unclamped);
                num_visible += plain.visible;
                num_clamped += plain.clamped;
                num_unclamped += plain.unclamped;
            }
        // The scene has all kinds, or the test would say little.
        EXPECT_GT(num_visible, 100u);
        EXPECT_GT(num_clamped, 100u);
        EXPECT_GT(num_unclamped, 100u);
    });
}

} // namespace
} // namespace relumine::relight
