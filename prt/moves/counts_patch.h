// Counts that replace some of a transfer's, and go back.
#pragma once

#include <cstdint>
#include <vector>

#include "prt/transfer/visible_counts.h"

namespace relumine::prt {

/// Counts of some pairs of blocks and clusters.
struct CountsPatch {
    /// What the patch has of a word of VisibleCounts.
    struct Word {
        /// VisibleCounts::word()
        std::uint64_t word = 0;
        /// The clusters that the patch has, a bit each
        std::uint64_t clusters = 0;
        /// Which of these clusters are seen whole and in part, as in VisibleCounts
        std::uint64_t visible = 0, mixed = 0;
        /// Where its counts begin in `counts`: so many times 16
        std::uint64_t first = 0;
    };
    /// Ascending, each word once
    std::vector<Word> words;
    std::vector<std::uint8_t> counts;

    /// Adds words that this patch does not have. They are ascending after sort().
    void append(const CountsPatch& other);
    void sort();
    [[nodiscard]] std::size_t num_pairs() const;
    [[nodiscard]] std::size_t num_bytes() const {
        return words.size() * sizeof(Word) + counts.size();
    }
};

/// Exchanges the counts of a patch with those of a transfer. A second call undoes the first.
///
/// Cost:    O(all counts), which move within their memory.
void exchange(VisibleCounts& counts, CountsPatch& patch);

} // namespace relumine::prt
