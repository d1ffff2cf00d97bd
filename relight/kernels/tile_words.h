// Which blocks of a tile have which work to do for a word of 64 clusters.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prt/transfer/transfer.h"
#include "relight/kernels/block_normals.h"

namespace relumine::relight {

/// Blocks of a tile of prt::VisibleCounts that have work to do for a word of 64 clusters; bit b
/// stands for the tile's block b. Loops over these bits jump to the work. Loops over all words
/// would ask each word, and the processor would guess the branch wrong.
struct TileWord {
    /// The block sees some clusters whole, and these lie above its receivers' horizons.
    std::uint64_t visible = 0;
    /// It sees all 64 clusters so.
    std::uint64_t full = 0;
    /// A run of such clusters begins or ends here. Runs go on from word to word.
    std::uint64_t edges = 0;
    /// The block sees some clusters in part.
    std::uint64_t mixed = 0;
    /// Mixed pairs of the scene before the first block's. The pairs of the tile's blocks follow
    /// each other.
    std::uint64_t mixed_before = 0;
    /// The block sees some clusters whole across a receiver's horizon: it has an entry in
    /// TileWords::across.
    std::uint64_t across = 0;
    /// Entries in TileWords::across before the first block's.
    std::uint64_t across_before = 0;

    // Clusters of the word, bit c for its cluster c.
    /// All of the tile's blocks see them whole, above their receivers' horizons.
    std::uint64_t whole_for_all = 0;
    /// Some block sees them whole, across a horizon or not.
    std::uint64_t seen_by_some = 0;
    /// Some block sees them in part.
    std::uint64_t mixed_for_some = 0;
};

/// The words of all tiles.
///
/// A cluster lies across a block's horizons when a receiver of the block has a part of its cell
/// below its horizon. There n.E may be negative, and max(n.E, 0) must be taken for each receiver
/// and colour. Elsewhere n.E >= 0 for any light of the cell, and whole clusters add up before they
/// meet the normals.
struct TileWords {
    /// [num_tiles * words_per_block], tile by tile.
    std::vector<TileWord> words;
    /// For each word and block in `across`: the clusters that are seen whole across a horizon.
    std::vector<std::uint64_t> across;

    /// Returns the clusters that a tile's block sees whole across a horizon.
    [[nodiscard]] std::uint64_t across_of(const TileWord& word, std::size_t block_of_tile) const {
        const std::uint64_t bit = std::uint64_t{1} << block_of_tile;
        if ((word.across & bit) == 0)
            return 0;
        return across[word.across_before +
                      static_cast<std::size_t>(std::popcount(word.across & (bit - 1)))];
    }
};

/// Finds the work of all tiles.
///
/// Cost:    O(visible pairs near the horizon); parallel (TBB).
[[nodiscard]] TileWords tile_words(const prt::Transfer& transfer,
                                   std::span<const BlockNormals> normals);
/// Finds it anew where blocks of a tile have other counts or normals than before.
///
/// Shape:   `changed` is [num_tiles], 0 where all are the same.
void update(TileWords& words, const prt::Transfer& transfer, std::span<const BlockNormals> normals,
            std::span<const std::uint64_t> changed);

} // namespace relumine::relight
