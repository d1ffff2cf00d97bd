// How much of each cluster each receiver sees: the precomputed data itself.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prt/receivers/block_size.h"

namespace relumine::prt {

/// Visible counts of one cluster for all receivers.
struct LeafColumn {
    /// [ceil(num_blocks / 64)] bit b is set where every receiver of block b counts
    /// 16.
    std::vector<std::uint64_t> visible;
    /// [ceil(num_blocks / 64)] bit b is set where block b has entries in `counts`.
    std::vector<std::uint64_t> mixed;
    /// [num_mixed_blocks * 16] in order of blocks.
    std::vector<std::uint8_t> counts;
};

/// The count c in 0..16 of every (receiver, leaf) pair, receivers in spatial order.
///
/// c is the visible part, in sixteenths, of what lies above the receiver's horizon: the weight of
/// the leaf's nine samples that reach the receiver over the weight of those that are above its
/// horizon. T_C(x) = c/16 max(n.w, 0)/pi for albedo 1.
///
/// Differs from [JN, Eq. 10], where samples below the horizon count as dark. The cosine already
/// leaves out the light below the horizon, so a cell across it would be darkened twice.
///
/// Most blocks of 16 receivers see all of a leaf or nothing. Two bits say so; only mixed blocks
/// store 16 counts. A receiver that has all of the leaf below its horizon takes either.
///
/// Layout (promised): tiles of 64 blocks; in a tile, words of 64 leaves ascending; in a word, the
/// tile's blocks; in a block, the word's mixed leaves ascending. So both uses stream through
/// memory. A relighting walks through a whole tile while its sums stay in the cache. An edit walks
/// through the few words that it touches, once per tile.
struct VisibleCounts {
    static constexpr std::size_t TileBlocks = 64;

    std::size_t num_receivers = 0;
    std::size_t num_leaves = 0;
    /// [num_blocks * words_per_block] by word(); a leaf's bit is set where all 16 receivers count
    /// 16.
    std::vector<std::uint64_t> visible = {};
    /// [num_blocks * words_per_block] by word(); a leaf's bit is set where it has 16 entries in
    /// `counts`, and then never in `visible`.
    std::vector<std::uint64_t> mixed = {};
    /// [num_blocks * words_per_block] by word(): mixed (block, leaf) pairs before the first leaf of
    /// the word.
    std::vector<std::uint64_t> mixed_before = {};
    /// [num_mixed * 16] values 0..16.
    std::vector<std::uint8_t> counts = {};

    [[nodiscard]] std::size_t num_blocks() const {
        return (num_receivers + BlockSize - 1) / BlockSize;
    }
    [[nodiscard]] std::size_t words_per_block() const { return (num_leaves + 63) / 64; }
    [[nodiscard]] std::size_t num_tiles() const {
        return (num_blocks() + TileBlocks - 1) / TileBlocks;
    }
    /// Returns the first block of a tile; for num_tiles(), the number of blocks.
    [[nodiscard]] std::size_t tile_begin(std::size_t tile) const {
        return std::min(tile * TileBlocks, num_blocks());
    }
    /// Returns the blocks of a tile: bit b stands for its block b.
    [[nodiscard]] std::uint64_t tile_blocks(std::size_t tile) const {
        const std::size_t size = tile_begin(tile + 1) - tile_begin(tile);
        return size == TileBlocks ? ~std::uint64_t{0} : (std::uint64_t{1} << size) - 1;
    }
    /// Returns where the word with leaves 64 w .. 64 w + 63 of a block lies.
    [[nodiscard]] std::size_t word(std::size_t block, std::size_t w) const {
        const std::size_t begin = tile_begin(block / TileBlocks);
        const std::size_t width = tile_begin(block / TileBlocks + 1) - begin;
        return begin * words_per_block() + w * width + (block - begin);
    }
    /// Returns the block that has a word of word().
    [[nodiscard]] std::size_t block_of(std::size_t word) const {
        const std::size_t tile = word / (TileBlocks * words_per_block());
        const std::size_t begin = tile_begin(tile);
        return begin + (word - begin * words_per_block()) % (tile_begin(tile + 1) - begin);
    }
    [[nodiscard]] std::size_t num_mixed() const { return counts.size() / BlockSize; }

    /// Returns the 16 counts of a mixed pair: word = word(block, leaf / 64), bit = leaf % 64.
    [[nodiscard]] const std::uint8_t* mixed_counts(std::size_t word, std::uint32_t bit) const {
        const std::uint64_t below = mixed[word] & ((std::uint64_t{1} << bit) - 1);
        return counts.data() +
               (mixed_before[word] + static_cast<std::size_t>(std::popcount(below))) * BlockSize;
    }

    /// Returns c of one pair. Too slow for hot loops.
    [[nodiscard]] int count(std::size_t receiver_place, std::size_t leaf) const;

    /// Fills mixed_before from mixed. `counts` must have 16 entries for every bit of mixed.
    ///
    /// Throws:  std::invalid_argument when sizes or bits contradict each other, or a count is above
    ///          16.
    void index();
};

} // namespace relumine::prt
