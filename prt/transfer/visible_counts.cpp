#include "prt/transfer/visible_counts.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <stdexcept>

#include "files/large_vector.h"
#include "files/parallel.h"

namespace relumine::prt {

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
    // By parts: their pairs first, and from those what lies before each part.
    constexpr std::size_t WordsPerPart = std::size_t{1} << 14;
    const std::size_t num_parts = (num_words + WordsPerPart - 1) / WordsPerPart;
    const auto for_words = [num_words](std::size_t part, const auto& visit) {
        const std::size_t end = std::min((part + 1) * WordsPerPart, num_words);
        for (std::size_t word = part * WordsPerPart; word < end; ++word)
            visit(word);
    };
    std::vector<std::uint64_t> before(num_parts + 1);
    std::atomic<bool> is_consistent = true;
    files::parallel_for(std::size_t{0}, num_parts, [&](std::size_t part) {
        std::uint64_t overlap = 0;
        for_words(part, [&](std::size_t word) {
            overlap |= visible[word] & mixed[word];
            before[part + 1] += static_cast<std::uint64_t>(std::popcount(mixed[word]));
        });
        if (overlap != 0)
            is_consistent = false;
    });
    if (!is_consistent)
        throw std::invalid_argument("visible counts: expected consistent bits");
    std::partial_sum(before.begin(), before.end(), before.begin());
    mixed_before = files::large_vector<std::uint64_t>(num_words);
    files::parallel_for(std::size_t{0}, num_parts, [&](std::size_t part) {
        std::uint64_t num_pairs = before[part];
        for_words(part, [&](std::size_t word) {
            mixed_before[word] = num_pairs;
            num_pairs += static_cast<std::uint64_t>(std::popcount(mixed[word]));
        });
    });
    for (std::size_t block = 0; block < num_blocks(); ++block) {
        const std::size_t last = word(block, words_per_block() - 1);
        if (((visible[last] | mixed[last]) & ~last_word_mask) != 0)
            throw std::invalid_argument("visible counts: expected no bits beyond the last leaf");
    }
    if (before.back() != num_mixed())
        throw std::invalid_argument("visible counts: expected 16 counts per mixed block");
    std::atomic<bool> is_in_range = true;
    files::parallel_for(files::IndexRange<std::size_t>(0, counts.size(), std::size_t{1} << 20),
                        [&](const files::IndexRange<std::size_t>& part) {
                            std::uint8_t largest = 0;
                            for (std::size_t i = part.begin(); i < part.end(); ++i)
                                largest = std::max(largest, counts[i]);
                            if (largest > 16)
                                is_in_range = false;
                        });
    if (!is_in_range)
        throw std::invalid_argument("visible counts: expected counts up to 16");
}

} // namespace relumine::prt
