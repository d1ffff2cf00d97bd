// How much a block of receivers sees of the cells above the clusters: what cuts look at that are
// made while the eye moves.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "cubemap/face.h"
#include "prt/transfer/transfer.h"

namespace relumine::relight {

/// The mean visible part of every inner cell of a transfer's quadtree, per block of 16 receivers.
///
/// Means are weighted by solid angle and by the cosine to the block's mean normal: below the
/// horizon nothing counts. Only what a block sees in part is kept, as a tree: each entry knows the
/// entries of its children, so a cut that descends looks nothing up. Four clusters below one cell
/// have the mean of their counts when it is asked for.
///
/// Cost:    O(mixed pairs of blocks and inner cells), once per scene; parallel.
/// Memory:  24 bytes for each mixed pair of a block and a cell that is not above clusters alone,
///          5 bytes where it is; below that of the counts.
class VisibilityPyramid {
public:
    /// What a block sees of a cell: nothing or all of it, or a part. A quad has four clusters
    /// below it, a branch has other cells, and a cluster's cells are all seen alike.
    enum class Kind : std::uint8_t { Hidden, Visible, Branch, Quad, Cluster };

    /// A cell as a block sees it. In one word: a cut that puts several together and copies them at
    /// once waits for the stores, which took up to a fifth of a look.
    class Place {
    public:
        Place() = default;
        explicit Place(Kind kind, std::uint32_t entry = 0, std::uint32_t branch = 0)
            : word_(std::uint64_t{entry} << 32u | std::uint64_t{branch} << KindBits |
                    static_cast<std::uint64_t>(kind)) {}

        [[nodiscard]] Kind kind() const {
            return static_cast<Kind>(word_ & ((1u << KindBits) - 1));
        }
        /// The entry of a branch or a quad; the counts' of a cluster.
        [[nodiscard]] std::uint32_t entry() const {
            return static_cast<std::uint32_t>(word_ >> 32u);
        }
        /// A branch's own number, for all blocks; below 2^24.
        [[nodiscard]] std::uint32_t branch() const {
            return static_cast<std::uint32_t>(word_) >> KindBits;
        }

    private:
        static constexpr std::uint32_t KindBits = 3;
        std::uint64_t word_ = 0;
    };

    /// How a block sees the four children of a cell, a bit each.
    struct Sights {
        std::uint32_t visible = 0, mixed = 0;
        /// Mixed ones with clusters below.
        std::uint32_t divided = 0;
    };

    /// Visible parts of 16 receivers, in units of `unit`.
    struct Parts {
        std::array<std::uint8_t, prt::BlockSize> parts{};
        float unit = 1.0f;
    };

    /// The transfer must outlive this object.
    ///
    /// Throws:  std::length_error for more than 2^32 mixed pairs or 2^26 clusters.
    explicit VisibilityPyramid(const prt::Transfer& transfer);

    [[nodiscard]] std::size_t num_bytes() const;

    [[nodiscard]] Place face(std::size_t block, std::uint32_t face) const {
        return faces_[block * cubemap::NumFaces + face];
    }

    /// Returns how the children are seen of a cell that is not hidden. A cluster's children are
    /// seen as the cluster is.
    [[nodiscard]] Sights sights(const Place& place) const {
        constexpr std::uint32_t All = 0xf;
        switch (place.kind()) {
        case Kind::Branch: {
            const std::uint32_t bits = links_[place.entry()].sights, mixed = bits >> 4u;
            const Family& family = families_[place.branch()];
            return {.visible = bits & All,
                    .mixed = mixed,
                    .divided = mixed & (family.branches | family.quads)};
        }
        case Kind::Quad: {
            const std::uint32_t bits = quad_sights_[place.entry()];
            return {.visible = bits & All, .mixed = bits >> 4u};
        }
        case Kind::Visible:
            return {.visible = All};
        default:
            return {.mixed = All};
        }
    }

    /// Returns child i of a cell, which its sights say is seen.
    [[nodiscard]] Place child(std::size_t block, const Place& place, const Sights& sights,
                              std::uint32_t i) const {
        const std::uint32_t bit = 1u << i, before = sights.mixed & (bit - 1);
        if ((sights.visible & bit) != 0)
            return Place(Kind::Visible);
        if (place.kind() == Kind::Quad)
            return Place(Kind::Cluster, quads_[place.entry()] + num_bits(before));
        if (place.kind() != Kind::Branch)
            return place;
        const Family& family = families_[place.branch()];
        const Links& links = links_[place.entry()];
        if ((family.branches & bit) != 0)
            return Place(Kind::Branch,
                         place.entry() + links.to_branch + num_bits(before & family.branches),
                         family.first_branch + num_bits(family.branches & (bit - 1)));
        if ((family.quads & bit) != 0)
            return Place(Kind::Quad, links.first_quad + num_bits(before & family.quads));
        return Place(Kind::Cluster, entry_of(block, leaves_[place.branch()][i]));
    }

    /// Returns where the parts of a mixed cell begin, or the counts of a quad's mixed clusters.
    [[nodiscard]] const std::uint8_t* first_part(const Place& mixed) const {
        const std::vector<std::uint8_t>& all =
            mixed.kind() == Kind::Branch ? parts_ : counts_.counts;
        const std::uint32_t entry =
            mixed.kind() == Kind::Quad ? quads_[mixed.entry()] : mixed.entry();
        return all.data() + std::size_t{entry} * prt::BlockSize;
    }

    /// Returns what each receiver sees of a cell.
    [[nodiscard]] Parts parts(const Place& place) const {
        Parts result;
        result.unit = copy_parts(place, result.parts);
        return result;
    }
    /// Sets what each receiver sees of a cell, in units of the result.
    float copy_parts(const Place& place, std::array<std::uint8_t, prt::BlockSize>& parts) const {
        switch (place.kind()) {
        case Kind::Branch:
        case Kind::Cluster:
            std::memcpy(parts.data(), first_part(place), prt::BlockSize);
            return place.kind() == Kind::Branch ? 1.0f / 255.0f : 1.0f / 16.0f;
        case Kind::Quad:
            add_quad(place, parts);
            return 1.0f / 64.0f;
        case Kind::Hidden:
        case Kind::Visible:
            break;
        }
        parts.fill(place.kind() == Kind::Visible ? 1 : 0);
        return 1.0f;
    }

private:
    class Builder;
    struct Node;
    struct BlockEntries;

    /// The children of a branch, for all blocks.
    struct Family {
        /// Those of its children that are branches follow each other.
        std::uint32_t first_branch = 0;
        /// Bits of its children that are branches, and that are quads; others are clusters.
        std::uint8_t branches = 0, quads = 0;
    };
    /// What a block sees of a branch: the children's bits, visible ones in the low half and mixed
    /// ones in the high half, and the first entries of mixed children. Those of branches are so
    /// many behind the branch's own.
    struct Links {
        std::uint32_t sights : 8 = 0, to_branch : 24 = 0;
        std::uint32_t first_quad = 0;
    };

    /// Returns how many of four bits are set. Most processors' own instruction is not known at
    /// compile time.
    static constexpr std::uint32_t num_bits(std::uint32_t bits) {
        return static_cast<std::uint32_t>(0x4332322132212110u >> 4u * bits & 7u);
    }
    void add_quad(const Place& place, std::array<std::uint8_t, prt::BlockSize>& parts) const;
    [[nodiscard]] std::uint32_t entry_of(std::size_t block, std::uint32_t leaf) const;
    void add_families(std::span<const Node> nodes, std::uint32_t node, std::uint32_t branch);
    void append(std::vector<BlockEntries>& blocks);

    const prt::VisibleCounts& counts_;
    /// [num_branches]
    std::vector<Family> families_;
    /// [num_branches] the numbers of children that are clusters.
    std::vector<std::array<std::uint32_t, 4>> leaves_;

    /// [num_blocks * 6]
    std::vector<Place> faces_;
    /// [num_mixed_branches] depth first in each block.
    std::vector<Links> links_;
    /// [num_mixed_branches * 16] in parts of 255.
    std::vector<std::uint8_t> parts_;
    /// [num_mixed_quads] bits as of branches; the counts of the first mixed cluster.
    std::vector<std::uint8_t> quad_sights_;
    std::vector<std::uint32_t> quads_;
};

} // namespace relumine::relight
