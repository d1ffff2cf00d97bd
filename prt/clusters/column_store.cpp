#include "prt/clusters/column_store.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "files/parallel.h"
#include "prt/free_memory.h"

namespace relumine::prt {

namespace {

constexpr std::size_t BlocksPerRun = 16 * VisibleCounts::TileBlocks;

constexpr std::size_t LargestChunk = std::size_t{1} << 18;

std::uint64_t word_at(const std::byte* bytes, std::size_t index) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes + index * sizeof word, sizeof word);
    return word;
}

std::size_t num_bits(std::span<const std::uint64_t> words) {
    std::size_t sum = 0;
    for (const std::uint64_t word : words)
        sum += static_cast<std::size_t>(std::popcount(word));
    return sum;
}

template<typename Visit>
void for_bits(std::uint64_t bits, const Visit& visit) {
    for (; bits != 0; bits &= bits - 1)
        visit(static_cast<std::size_t>(std::countr_zero(bits)));
}

} // namespace

/// Chunks grow with the run, so that small scenes take little.
std::byte* ColumnStore::Run::allocate(std::size_t size) {
    if (size > num_free) {
        num_free = std::max(
            size, static_cast<std::size_t>(std::min<std::uint64_t>(num_bytes, LargestChunk)));
        chunks.push_back(std::make_unique_for_overwrite<std::byte[]>(num_free));
        free = chunks.back().get();
    }
    std::byte* const result = free;
    free += size;
    num_free -= size;
    num_bytes += size;
    return result;
}

ColumnStore::ColumnStore(std::size_t num_receivers) : num_receivers_(num_receivers) {
    const std::size_t num_blocks = (num_receivers + BlockSize - 1) / BlockSize;
    for (std::size_t begin = 0; begin < num_blocks; begin += BlocksPerRun)
        runs_.push_back(
            {.first_block = begin, .num_blocks = std::min(BlocksPerRun, num_blocks - begin)});
}

void ColumnStore::add(const LeafColumn& column) {
    const std::uint8_t* counts = column.counts.data();
    for (Run& run : runs_) {
        const std::size_t first = run.first_block / 64;
        const std::size_t size = run.num_words() * sizeof(std::uint64_t);
        const std::size_t num_counts =
            num_bits(std::span(column.mixed).subspan(first, run.num_words())) * BlockSize;
        std::byte* entry = run.allocate(2 * size + num_counts);
        run.entries.push_back(entry);
        std::memcpy(entry, column.visible.data() + first, size);
        std::memcpy(entry + size, column.mixed.data() + first, size);
        if (num_counts != 0)
            std::memcpy(entry + 2 * size, counts, num_counts);
        counts += num_counts;
    }
    ++size_;
}

std::size_t ColumnStore::num_tiles() const {
    return (num_receivers_ + VisibleCounts::TileBlocks * BlockSize - 1) /
           (VisibleCounts::TileBlocks * BlockSize);
}

TileColumn ColumnStore::tile(std::size_t index, std::size_t tile) const {
    constexpr std::size_t TilesPerRun = BlocksPerRun / VisibleCounts::TileBlocks;
    const Run& run = runs_[tile / TilesPerRun];
    const std::byte* const entry = run.entries[index];
    const std::size_t num_words = run.num_words(), own = tile % TilesPerRun;
    const auto num_counts = [&](std::size_t word) {
        return static_cast<std::size_t>(std::popcount(word_at(entry, num_words + word))) *
               BlockSize;
    };
    const auto* counts =
        reinterpret_cast<const std::uint8_t*>(entry + 2 * num_words * sizeof(std::uint64_t));
    for (std::size_t word = 0; word < own; ++word)
        counts += num_counts(word);
    return {.visible = word_at(entry, own),
            .mixed = word_at(entry, num_words + own),
            .counts = {counts, num_counts(own)}};
}

VisibleCounts ColumnStore::take(std::span<const std::uint32_t> order) {
    VisibleCounts result{.num_receivers = num_receivers_, .num_leaves = order.size()};
    const std::size_t num_words = result.num_blocks() * result.words_per_block();
    result.visible.reserve(num_words);
    result.mixed.reserve(num_words);
    result.mixed_before.reserve(num_words);
    std::uint64_t num_counts = 0;
    for (const Run& run : runs_)
        num_counts +=
            run.num_bytes - run.entries.size() * 2 * run.num_words() * sizeof(std::uint64_t);
    result.counts.reserve(static_cast<std::size_t>(num_counts));
    // Memory that was reserved is not there before it is written to.
    for (Run& run : runs_) {
        join(run, order, result);
        run = {};
        return_free_memory();
    }
    result.index();
    runs_.clear();
    size_ = 0;
    return result;
}

/// Appends a run, whose tiles follow the ones before.
void ColumnStore::join(const Run& run, std::span<const std::uint32_t> order,
                       VisibleCounts& result) const {
    const std::size_t words_per_block = result.words_per_block();
    const std::size_t first_word = run.first_block * words_per_block;
    const std::size_t end_word = first_word + run.num_blocks * words_per_block;
    result.visible.resize(end_word);
    result.mixed.resize(end_word);

    // Transposes the bits. Every task owns a tile.
    static_assert(VisibleCounts::TileBlocks == 64);
    files::parallel_for(std::size_t{0}, run.num_words(), [&](std::size_t tile) {
        const std::size_t begin = run.first_block + tile * VisibleCounts::TileBlocks;
        for (std::size_t leaf = 0; leaf < order.size(); ++leaf) {
            const std::byte* const entry = run.entries[order[leaf]];
            const std::size_t word = result.word(begin, leaf / 64);
            const std::uint64_t bit = std::uint64_t{1} << leaf % 64;
            for_bits(word_at(entry, tile), [&](auto b) { result.visible[word + b] |= bit; });
            for_bits(word_at(entry, run.num_words() + tile),
                     [&](auto b) { result.mixed[word + b] |= bit; });
        }
    });
    std::uint64_t num_pairs = result.num_mixed();
    for (std::size_t word = first_word; word < end_word; ++word) {
        result.mixed_before.push_back(num_pairs);
        num_pairs += static_cast<std::uint64_t>(std::popcount(result.mixed[word]));
    }
    result.counts.resize(static_cast<std::size_t>(num_pairs) * BlockSize);

    // Scatters each column's counts to their blocks. A (leaf, block) pair has one place, so leaves
    // can run in parallel.
    files::parallel_for(std::size_t{0}, order.size(), [&](std::size_t leaf) {
        const std::byte* const entry = run.entries[order[leaf]];
        const std::byte* source = entry + 2 * run.num_words() * sizeof(std::uint64_t);
        for (std::size_t tile = 0; tile < run.num_words(); ++tile)
            for_bits(word_at(entry, run.num_words() + tile), [&](std::size_t b) {
                const std::size_t block = run.first_block + tile * VisibleCounts::TileBlocks + b;
                auto* target = const_cast<std::uint8_t*>(result.mixed_counts(
                    result.word(block, leaf / 64), static_cast<std::uint32_t>(leaf % 64)));
                std::memcpy(target, source, BlockSize);
                source += BlockSize;
            });
    });
}

} // namespace relumine::prt
