#include "prt/moves/counts_patch.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <ranges>
#include <span>
#include <utility>

namespace relumine::prt {

namespace {

std::size_t num_bits(std::uint64_t bits) {
    return static_cast<std::size_t>(std::popcount(bits));
}

/// Appends so many counts of 16 receivers.
void append(std::vector<std::uint8_t>& to, const std::vector<std::uint8_t>& from, std::size_t first,
            std::size_t count) {
    const auto begin = from.begin() + static_cast<std::ptrdiff_t>(first * BlockSize);
    to.insert(to.end(), begin, begin + static_cast<std::ptrdiff_t>(count * BlockSize));
}

/// The counts of a patched word, where they lie and what replaces them: numbers of pairs.
struct Replacement {
    std::size_t word = 0;
    std::size_t begin = 0, end = 0;
    std::size_t new_size = 0;
};

/// Moves what lies between replaced counts to its new places. There is room for it.
void make_room(std::vector<std::uint8_t>& counts, std::size_t num_pairs,
               std::span<const Replacement> replaced) {
    struct Run {
        std::size_t begin, end;
        std::ptrdiff_t by;
    };
    std::vector<Run> runs;
    std::ptrdiff_t by = 0;
    for (std::size_t i = 0; i < replaced.size(); ++i) {
        const Replacement& own = replaced[i];
        by += static_cast<std::ptrdiff_t>(own.new_size) -
              static_cast<std::ptrdiff_t>(own.end - own.begin);
        const std::size_t end = i + 1 < replaced.size() ? replaced[i + 1].begin : num_pairs;
        if (by != 0 && end != own.end)
            runs.push_back({own.end, end, by});
    }
    const auto move = [&](const Run& run) {
        std::uint8_t* const begin = counts.data() + run.begin * BlockSize;
        std::memmove(begin + run.by * static_cast<std::ptrdiff_t>(BlockSize), begin,
                     (run.end - run.begin) * BlockSize);
    };
    // No run is written over one that is still to be moved.
    for (const Run& run : runs)
        if (run.by < 0)
            move(run);
    for (const Run& run : runs | std::views::reverse)
        if (run.by > 0)
            move(run);
}

} // namespace

void CountsPatch::append(const CountsPatch& other) {
    const std::uint64_t first = counts.size() / BlockSize;
    for (Word word : other.words) {
        word.first += first;
        words.push_back(word);
    }
    counts.insert(counts.end(), other.counts.begin(), other.counts.end());
}

void CountsPatch::sort() {
    std::ranges::sort(words, {}, &Word::word);
}

std::size_t CountsPatch::num_pairs() const {
    std::size_t sum = 0;
    for (const Word& word : words)
        sum += num_bits(word.clusters);
    return sum;
}

void exchange(VisibleCounts& counts, CountsPatch& patch) {
    if (patch.words.empty())
        return;
    CountsPatch before;
    before.words.reserve(patch.words.size());
    std::vector<Replacement> replaced;
    std::vector<std::uint8_t> fresh; // of the replaced words
    for (const CountsPatch::Word& own : patch.words) {
        std::uint64_t& visible = counts.visible[own.word];
        std::uint64_t& mixed = counts.mixed[own.word];
        const std::size_t begin = counts.mixed_before[own.word], begin_fresh = fresh.size();
        std::size_t at = begin, of_patch = own.first;
        before.words.push_back({own.word, own.clusters, visible & own.clusters,
                                mixed & own.clusters, before.counts.size() / BlockSize});
        for (std::uint64_t rest = mixed | own.mixed; rest != 0; rest &= rest - 1) {
            const std::uint64_t bit = rest & (~rest + 1);
            const bool is_patched = (own.clusters & bit) != 0;
            if ((mixed & bit) != 0)
                append(is_patched ? before.counts : fresh, counts.counts, at++, 1);
            if ((own.mixed & bit) != 0)
                append(fresh, patch.counts, of_patch++, 1);
        }
        replaced.push_back({own.word, begin, at, (fresh.size() - begin_fresh) / BlockSize});
        visible = (visible & ~own.clusters) | own.visible;
        mixed = (mixed & ~own.clusters) | own.mixed;
    }
    const std::size_t size = counts.counts.size();
    std::size_t new_size = size + fresh.size();
    for (const Replacement& own : replaced)
        new_size -= (own.end - own.begin) * BlockSize;
    if (new_size > counts.counts.capacity())
        counts.counts.reserve(new_size + new_size / 16); // the next move hardly needs more
    counts.counts.resize(std::max(size, new_size));
    make_room(counts.counts, size / BlockSize, replaced);
    counts.counts.resize(new_size);
    std::size_t from_fresh = 0;
    std::uint64_t by = 0; // modulo 2^64
    for (std::size_t i = 0; i < replaced.size(); ++i) {
        const Replacement& own = replaced[i];
        std::copy_n(fresh.data() + from_fresh, own.new_size * BlockSize,
                    counts.counts.data() + (own.begin + by) * BlockSize);
        from_fresh += own.new_size * BlockSize;
        by += own.new_size - (own.end - own.begin);
        const std::size_t end =
            i + 1 < replaced.size() ? replaced[i + 1].word + 1 : counts.mixed_before.size();
        for (std::size_t word = own.word + 1; word < end; ++word)
            counts.mixed_before[word] += by;
    }
    patch = std::move(before);
}

} // namespace relumine::prt
