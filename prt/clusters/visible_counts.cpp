#include "prt/clusters/visible_counts.h"

#include <algorithm>
#include <stdexcept>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace relumine::prt {

namespace {

bool bit_of(const std::vector<std::uint64_t>& words, std::size_t bit) {
    return (words[bit / 64] >> (bit % 64) & 1u) != 0;
}

} // namespace

int VisibleCounts::count(std::size_t receiver_place, std::size_t leaf) const {
    const std::size_t word = this->word(receiver_place / BlockSize, leaf / 64);
    const auto bit = static_cast<std::uint32_t>(leaf % 64);
    if ((visible[word] >> bit & 1u) != 0)
        return 16;
    if ((mixed[word] >> bit & 1u) == 0)
        return 0;
    return mixed_counts(word, bit)[receiver_place % BlockSize];
}

void VisibleCounts::index() {
    const std::size_t num_words = num_blocks() * words_per_block();
    if (visible.size() != num_words || mixed.size() != num_words || counts.size() % BlockSize != 0)
        throw std::invalid_argument("visible counts: expected one bit per block and leaf");
    const std::uint64_t last_word_mask =
        num_leaves % 64 == 0 ? ~std::uint64_t{0} : (std::uint64_t{1} << num_leaves % 64) - 1;
    mixed_before.resize(num_words);
    std::uint64_t num_pairs = 0;
    for (std::size_t word = 0; word < num_words; ++word) {
        if ((visible[word] & mixed[word]) != 0)
            throw std::invalid_argument("visible counts: expected consistent bits");
        mixed_before[word] = num_pairs;
        num_pairs += static_cast<std::uint64_t>(std::popcount(mixed[word]));
    }
    for (std::size_t block = 0; block < num_blocks(); ++block) {
        const std::size_t last = word(block, words_per_block() - 1);
        if (((visible[last] | mixed[last]) & ~last_word_mask) != 0)
            throw std::invalid_argument("visible counts: expected no bits beyond the last leaf");
    }
    if (num_pairs != num_mixed())
        throw std::invalid_argument("visible counts: expected 16 counts per mixed block");
    if (std::any_of(counts.begin(), counts.end(), [](std::uint8_t c) { return c > 16; }))
        throw std::invalid_argument("visible counts: expected counts up to 16");
}

VisibleCounts counts_from_columns(std::vector<LeafColumn>&& columns, std::size_t num_receivers) {
    VisibleCounts result{.num_receivers = num_receivers, .num_leaves = columns.size()};
    const std::size_t num_blocks = result.num_blocks();
    result.visible.resize(num_blocks * result.words_per_block());
    result.mixed.resize(num_blocks * result.words_per_block());

    // Transpose the class bits. Every task owns whole blocks.
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, num_blocks, 64), [&](const auto& blocks) {
        for (std::size_t leaf = 0; leaf < columns.size(); ++leaf) {
            for (std::size_t block = blocks.begin(); block < blocks.end(); ++block) {
                const std::size_t word = result.word(block, leaf / 64);
                result.visible[word] |=
                    static_cast<std::uint64_t>(bit_of(columns[leaf].visible, block)) << (leaf % 64);
                result.mixed[word] |= static_cast<std::uint64_t>(bit_of(columns[leaf].mixed, block))
                                      << (leaf % 64);
            }
        }
    });
    std::size_t num_entries = 0;
    for (const LeafColumn& column : columns)
        num_entries += column.counts.size();
    result.counts.resize(num_entries);
    result.index();

    // Scatter each column's counts to their blocks. A (leaf, block) pair has one place, so leaves
    // can run in parallel.
    tbb::parallel_for(std::size_t{0}, columns.size(), [&](std::size_t leaf) {
        LeafColumn& column = columns[leaf];
        const std::uint8_t* source = column.counts.data();
        for (std::size_t block = 0; block < num_blocks; ++block) {
            if (!bit_of(column.mixed, block))
                continue;
            const std::size_t word = result.word(block, leaf / 64);
            auto* target = const_cast<std::uint8_t*>(
                result.mixed_counts(word, static_cast<std::uint32_t>(leaf % 64)));
            std::copy_n(source, BlockSize, target);
            source += BlockSize;
        }
        column = {};
    });
    return result;
}

} // namespace relumine::prt
