#include "prt/scene/older_counts.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>
#include <vector>

#include "files/parallel.h"
#include "prt/clusters/cluster_kernels.h"
#include "prt/clusters/horizon.h"
#include "prt/clusters/lattice.h"

namespace relumine::prt {

void move_into_tiles(VisibleCounts& counts) {
    const std::vector<std::uint64_t> visible = std::exchange(counts.visible, {});
    const std::vector<std::uint64_t> mixed = std::exchange(counts.mixed, {});
    const std::size_t num_words = counts.words_per_block();
    if (visible.size() == counts.num_blocks() * num_words && mixed.size() == visible.size()) {
        counts.visible.resize(visible.size());
        counts.mixed.resize(mixed.size());
        for (std::size_t block = 0; block < counts.num_blocks(); ++block)
            for (std::size_t w = 0; w < num_words; ++w) {
                counts.visible[counts.word(block, w)] = visible[block * num_words + w];
                counts.mixed[counts.word(block, w)] = mixed[block * num_words + w];
            }
    }
    counts.index(); // which refuses other sizes
    const std::vector<std::uint8_t> entries = std::exchange(counts.counts, {});
    counts.counts.resize(entries.size());
    auto next = entries.begin();
    for (std::size_t block = 0; block < counts.num_blocks(); ++block)
        for (std::size_t w = 0; w < num_words; ++w) {
            const std::size_t word = counts.word(block, w);
            const auto size = static_cast<std::ptrdiff_t>(
                static_cast<std::size_t>(std::popcount(counts.mixed[word])) * BlockSize);
            std::copy(next, next + size,
                      counts.counts.begin() +
                          static_cast<std::ptrdiff_t>(counts.mixed_before[word] * BlockSize));
            next += size;
        }
}

void count_above_horizon(VisibleCounts& counts, const Quadtree& quadtree,
                         std::span<const glm::vec3> normals, std::uint32_t texel_level) {
    const NormalArrays arrays(normals);
    std::vector<std::array<glm::vec3, SamplesPerCell>> directions;
    directions.reserve(quadtree.num_leaves());
    for (const Cell& cell : quadtree.leaves()) {
        const std::array<LatticePoint, SamplesPerCell> points = lattice_points(cell);
        std::transform(points.begin(), points.end(), directions.emplace_back().begin(), direction);
    }
    std::vector<std::vector<std::uint8_t>> of_tiles(counts.num_tiles());
    files::parallel_for(std::size_t{0}, counts.num_tiles(), [&](std::size_t tile) {
        const std::size_t first = counts.tile_begin(tile);
        const std::size_t width = counts.tile_begin(tile + 1) - first;
        for (std::size_t i = 0; i < width * counts.words_per_block(); ++i) {
            const std::size_t word = first * counts.words_per_block() + i;
            const std::size_t block = first + i % width;
            const std::uint8_t* entry = counts.mixed_counts(word, 0);
            std::uint64_t wholly_visible = 0;
            for (std::uint64_t bits = counts.mixed[word]; bits != 0;
                 bits &= bits - 1, entry += BlockSize) {
                const std::size_t leaf =
                    i / width * 64 + static_cast<std::size_t>(std::countr_zero(bits));
                const bool is_texel = quadtree.leaves()[leaf].level == texel_level;
                std::array<std::uint8_t, BlockSize> of_block;
                std::copy_n(entry, BlockSize, of_block.begin());
                const std::array<std::uint8_t, BlockSize> above =
                    weights_of(samples_above_horizon(arrays, block * BlockSize, directions[leaf]),
                               is_texel ? CentreWeights : SampleWeights);
                if (divide_by_weight_above(of_block, above))
                    wholly_visible |= bits & (~bits + 1);
                else
                    of_tiles[tile].insert(of_tiles[tile].end(), of_block.begin(), of_block.end());
            }
            counts.visible[word] |= wholly_visible;
            counts.mixed[word] &= ~wholly_visible;
        }
    });
    counts.counts.clear();
    for (const std::vector<std::uint8_t>& of_tile : of_tiles)
        counts.counts.insert(counts.counts.end(), of_tile.begin(), of_tile.end());
    counts.index();
}

} // namespace relumine::prt
