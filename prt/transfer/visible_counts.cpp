#include "prt/transfer/visible_counts.h"

#include <algorithm>
#include <stdexcept>

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

} // namespace relumine::prt
