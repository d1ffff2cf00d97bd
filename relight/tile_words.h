// Which blocks of a tile have which work to do for a word of 64 clusters.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prt/transfer.h"
#include "relight/block_normals.h"

namespace relumine::relight {

/// Blocks of a tile of prt::VisibleCounts that see any of a word's 64 clusters; bit b: the tile's
/// block b. Loops over these bits jump to where the work is, where loops over all words would ask
/// each, and guess wrong.
struct TileWord {
    /// Some clusters whole
    std::uint64_t visible = 0;
    /// Some in part, and the sums need max(n.E, 0)
    std::uint64_t clamped = 0;
    /// Some in part, but the clamp can be left out; never set with `clamped`
    std::uint64_t unclamped = 0;
};

/// [num_tiles * words_per_block], tile by tile. A word is unclamped when each of the block's
/// receivers has the whole cell of every cluster that it counts any of above its horizon: then n.E
/// >= 0 whatever light the cell has, and the sum of c max(n.E, 0) over the word is n . sum of c E,
/// which costs a third less. So are half of the bunny's. O(mixed pairs); parallel (TBB).
[[nodiscard]] std::vector<TileWord> tile_words(const prt::Transfer& transfer,
                                               std::span<const BlockNormals> normals);

} // namespace relumine::relight
