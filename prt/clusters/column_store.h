// The visible counts of finished clusters while others are still being found.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "prt/transfer/visible_counts.h"

namespace relumine::prt {

/// What a column has of a tile.
struct TileColumn {
    std::uint64_t visible = 0;
    std::uint64_t mixed = 0;
    std::span<const std::uint8_t> counts = {};
};

/// Keeps columns in the order in which they come, and joins them at the end.
///
/// Columns are cut into runs of receivers, and each run has memory of its own. So the memory of a
/// run can go back to the system as soon as it is joined: columns and result are never in memory
/// together.
class ColumnStore {
public:
    explicit ColumnStore(std::size_t num_receivers);

    void add(const LeafColumn& column);
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] std::size_t num_tiles() const;
    /// Returns a tile of the column that came as number `index`. It is a view of the store.
    [[nodiscard]] TileColumn tile(std::size_t index, std::size_t tile) const;

    /// Joins the columns, and leaves none: column number order[leaf] becomes that leaf's.
    ///
    /// Memory:  the result, and a run of 16,384 receivers twice.
    [[nodiscard]] VisibleCounts take(std::span<const std::uint32_t> order);

private:
    /// The part of all columns that belongs to neighbouring tiles.
    struct Run {
        std::size_t first_block = 0;
        std::size_t num_blocks = 0;
        /// [size()] for each column its words of `visible`, its words of `mixed` and its counts.
        std::vector<const std::byte*> entries = {};
        std::uint64_t num_bytes = 0;
        std::vector<std::unique_ptr<std::byte[]>> chunks = {};
        /// Where the last chunk is free, and how much.
        std::byte* free = nullptr;
        std::size_t num_free = 0;

        [[nodiscard]] std::size_t num_words() const { return (num_blocks + 63) / 64; }
        std::byte* allocate(std::size_t size);
    };

    void join(const Run& run, std::span<const std::uint32_t> order, VisibleCounts& result) const;

    std::size_t num_receivers_;
    std::size_t size_ = 0;
    std::vector<Run> runs_;
};

} // namespace relumine::prt
