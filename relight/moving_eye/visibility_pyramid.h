// How much a block of receivers sees of the cells above the clusters: what cuts look at that are
// made while the eye moves.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prt/transfer/transfer.h"

namespace relumine::relight {

/// The mean visible part of every inner cell of a transfer's quadtree, per block of 16 receivers.
///
/// Means are weighted by solid angle and by the cosine to the block's mean normal: below the
/// horizon nothing counts. A cell whose four children are clusters has its mean from their counts
/// when it is asked for, so only the cells above are stored.
///
/// Cost:    O(mixed pairs of blocks and inner cells), once per scene; parallel.
/// Memory:  16 bytes for each mixed pair of a block and a stored cell, and 2.5 bits for each pair;
///          below that of the counts.
class VisibilityPyramid {
public:
    /// Of a cell, by all receivers of a block.
    enum class Sight : std::uint8_t { Hidden, Mixed, Visible };

    /// A cell of the quadtree. The faces come first.
    struct Node {
        /// The first of four consecutive nodes; 0 for a cluster.
        std::uint32_t first_child = 0;
        /// Its clusters are [first_leaf, end_leaf).
        std::uint32_t first_leaf = 0, end_leaf = 0;
        /// Its number among the stored cells; NotStored for others.
        std::uint32_t stored = NotStored;
    };
    static constexpr std::uint32_t NotStored = ~std::uint32_t{0};

    /// Visible parts of 16 receivers, in units of `unit`.
    struct Parts {
        std::array<std::uint8_t, prt::BlockSize> parts{};
        float unit = 1.0f;
    };

    /// The transfer must outlive this object.
    explicit VisibilityPyramid(const prt::Transfer& transfer);

    [[nodiscard]] std::span<const Node> nodes() const { return nodes_; }
    [[nodiscard]] std::size_t num_bytes() const;

    [[nodiscard]] Sight sight(std::size_t block, const Node& node) const {
        if (node.stored != NotStored) {
            const std::size_t word = block * words_per_block_ + node.stored / 64;
            return sight_of(visible_[word] >> node.stored % 64, mixed_[word] >> node.stored % 64);
        }
        if (node.first_child == 0)
            return sight_of_leaf(block, node.first_leaf);
        const Sight first = sight_of_leaf(block, node.first_leaf);
        for (std::uint32_t i = 1; i < 4; ++i)
            if (first == Sight::Mixed || sight_of_leaf(block, node.first_leaf + i) != first)
                return Sight::Mixed;
        return first;
    }

    /// Returns what each receiver sees of a mixed node.
    [[nodiscard]] Parts parts(std::size_t block, const Node& node) const;

private:
    class Builder;

    static Sight sight_of(std::uint64_t visible, std::uint64_t mixed) {
        return (visible & 1u) != 0 ? Sight::Visible
               : (mixed & 1u) != 0 ? Sight::Mixed
                                   : Sight::Hidden;
    }
    [[nodiscard]] Sight sight_of_leaf(std::size_t block, std::uint32_t leaf) const {
        const std::size_t word = counts_.word(block, leaf / 64);
        return sight_of(counts_.visible[word] >> leaf % 64, counts_.mixed[word] >> leaf % 64);
    }
    void add_nodes(std::uint32_t node, const std::vector<bool>& flags, std::size_t& next_flag);

    const prt::VisibleCounts& counts_;
    std::vector<Node> nodes_;
    std::uint32_t num_leaves_ = 0, num_stored_ = 0;
    std::size_t words_per_block_ = 0;
    /// [num_blocks * words_per_block], a bit for each stored cell, as prt::VisibleCounts.
    std::vector<std::uint64_t> visible_, mixed_;
    /// [num_blocks * words_per_block]: mixed pairs before the word.
    std::vector<std::uint32_t> mixed_before_;
    /// [num_mixed * 16] in parts of 255.
    std::vector<std::uint8_t> parts_;
};

} // namespace relumine::relight
