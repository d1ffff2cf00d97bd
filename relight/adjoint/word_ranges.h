// Clusters shared among threads by whole words of 64: nobody else writes what a thread sums.
#pragma once

#include <algorithm>
#include <cstddef>

#include "files/parallel.h"
#include "prt/transfer/visible_counts.h"

namespace relumine::relight {

/// Calls work(first, last) for ranges of words that hold all clusters, in parallel. They are few,
/// as each reads the weights of all receivers.
template<class Work>
void for_word_ranges(const prt::VisibleCounts& counts, const Work& work) {
    constexpr std::size_t TasksPerThread = 4;
    const std::size_t num_words = counts.words_per_block();
    files::parallel_for(
        files::IndexRange<std::size_t>(
            0, num_words,
            std::max<std::size_t>(1, num_words / (TasksPerThread * files::num_threads()))),
        [&](const auto& words) { work(words.begin(), words.end()); });
}

} // namespace relumine::relight
