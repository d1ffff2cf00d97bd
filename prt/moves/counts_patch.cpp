#include "prt/moves/counts_patch.h"

#include <bit>
#include <cstddef>
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

} // namespace

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
    std::vector<std::uint8_t> merged;
    merged.reserve(counts.counts.size() + patch.counts.size());
    std::size_t num_read = 0;
    for (const CountsPatch::Word& own : patch.words) {
        std::uint64_t& visible = counts.visible[own.word];
        std::uint64_t& mixed = counts.mixed[own.word];
        std::size_t at = counts.mixed_before[own.word], of_patch = own.first;
        append(merged, counts.counts, num_read, at - num_read);
        before.words.push_back({own.word, own.clusters, visible & own.clusters,
                                mixed & own.clusters, before.counts.size() / BlockSize});
        for (std::uint64_t rest = mixed | own.mixed; rest != 0; rest &= rest - 1) {
            const std::uint64_t bit = rest & (~rest + 1);
            const bool is_patched = (own.clusters & bit) != 0;
            if ((mixed & bit) != 0)
                append(is_patched ? before.counts : merged, counts.counts, at++, 1);
            if ((own.mixed & bit) != 0)
                append(merged, patch.counts, of_patch++, 1);
        }
        num_read = at;
        visible = (visible & ~own.clusters) | own.visible;
        mixed = (mixed & ~own.clusters) | own.mixed;
    }
    append(merged, counts.counts, num_read, counts.num_mixed() - num_read);
    counts.counts = std::move(merged);
    counts.index();
    patch = std::move(before);
}

} // namespace relumine::prt
