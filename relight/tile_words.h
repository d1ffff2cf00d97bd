// Which blocks of a tile have which work to do for a word of 64 clusters.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prt/transfer.h"
#include "relight/block_normals.h"

namespace relumine::relight {

/// Blocks of a tile of prt::VisibleCounts that see any of a word's 64 clusters; bit b stands for
/// the tile's block b. Loops over these bits jump to the work. Loops over all words would ask each
/// word, and the processor would guess the branch wrong.
struct TileWord {
    /// The block sees some clusters whole.
    std::uint64_t visible = 0;
    /// The block sees some clusters in part, and the sums need max(n.E, 0).
    std::uint64_t clamped = 0;
    /// The block sees some clusters in part, and the sums need no clamp. Never set with `clamped`.
    std::uint64_t unclamped = 0;
};

/// Returns the words of all tiles.
///
/// A word is unclamped when each receiver of the block has the whole cell of every cluster that it
/// counts above its horizon. Then n.E >= 0 for any light of the cell, and the sum of c max(n.E, 0)
/// over the word is n . sum of c E, which costs a third less. Half of the bunny's words are
/// unclamped.
///
/// Shape:   [num_tiles * words_per_block], tile by tile.
/// Cost:    O(mixed pairs); parallel (TBB).
[[nodiscard]] std::vector<TileWord> tile_words(const prt::Transfer& transfer,
                                               std::span<const BlockNormals> normals);

} // namespace relumine::relight
