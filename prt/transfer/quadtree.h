// The quadtree over the six cube faces whose leaves are the light clusters.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "cubemap/face.h"

namespace relumine::prt {

/// A dyadic square of a face: [x, x + 1] x [y, y + 1] in units of 2^-level, x to the right and y
/// down as in cubemap::Face. Cells are squares of the continuous face, not ranges of texels, so a
/// tree fits environments of any resolution.
struct Cell {
    cubemap::Face face = cubemap::Face::PositiveX;
    std::uint8_t level = 0;
    std::uint32_t x = 0;
    std::uint32_t y = 0;

    /// Returns child i. Order: (0,0) (1,0) (0,1) (1,1) of (right, down).
    [[nodiscard]] Cell child(std::uint32_t i) const {
        return {face, static_cast<std::uint8_t>(level + 1), 2 * x + (i & 1u), 2 * y + (i >> 1u)};
    }
    /// Returns the cell of a level that holds this one; this one where it is no deeper.
    [[nodiscard]] Cell above(std::uint32_t of_level) const {
        if (level <= of_level)
            return *this;
        const std::uint32_t up = level - of_level;
        return {face, static_cast<std::uint8_t>(of_level), x >> up, y >> up};
    }
    /// Length of the cell's side; a whole face has 1.
    [[nodiscard]] double size() const { return 1.0 / static_cast<double>(1u << level); }
    bool operator==(const Cell&) const = default;
};

/// A rectangle of a face, [s0, s1] x [t0, t1] in face coordinates.
struct FaceRectangle {
    cubemap::Face face = cubemap::Face::PositiveX;
    double s0 = 0.0;
    double t0 = 0.0;
    double s1 = 1.0;
    double t1 = 1.0;
};

/// Deepest level of a cell: 2^14 texels along a face's edge.
inline constexpr std::uint32_t MaxLevel = 14;

/// Returns the level whose cells are no larger than the texels of a 6 x R x R environment.
[[nodiscard]] constexpr std::uint32_t texel_level(std::uint32_t face_resolution) {
    return static_cast<std::uint32_t>(std::bit_width(face_resolution - 1));
}

/// Six quadtrees, one per face; immutable. Leaves are numbered depth first, face by face, so every
/// subtree owns a range of leaves.
class Quadtree {
public:
    /// The tree with no split: six leaves.
    Quadtree();
    /// Builds the tree from its depth-first split flags (true = split), as split_flags() returns
    /// them.
    ///
    /// Throws:  std::invalid_argument when the flags end early, go on after the last leaf or go
    ///          deeper than MaxLevel.
    explicit Quadtree(const std::vector<bool>& split_flags);
    /// Builds the tree whose cells are split where `is_split` says so. It is asked depth first.
    [[nodiscard]] static Quadtree of(const std::function<bool(const Cell&)>& is_split);

    [[nodiscard]] std::size_t num_leaves() const { return leaves_.size(); }
    [[nodiscard]] std::span<const Cell> leaves() const { return leaves_; }
    [[nodiscard]] std::vector<bool> split_flags() const;

    /// Appends the leaves whose cells share area with the rectangle to `leaf_indices`, in ascending
    /// order. Walks the tree from the face's root [JN, Section 5.2].
    void find_leaves(const FaceRectangle& rectangle,
                     std::vector<std::uint32_t>& leaf_indices) const;

    /// Returns the leaf whose cell holds a point; on a border, the cell to the right and below.
    [[nodiscard]] std::uint32_t leaf_at(const cubemap::FacePoint& point) const;

private:
    struct Node {
        /// Index of four consecutive nodes, 0 for a leaf.
        std::uint32_t first_child = 0;
        /// Leaf index; meaningful for a leaf only.
        std::uint32_t leaf = 0;
    };
    void build(std::uint32_t node, const Cell& cell, const std::vector<bool>& split_flags,
               std::size_t& next_flag);
    void find(std::uint32_t node, const Cell& cell, const FaceRectangle& rectangle,
              std::vector<std::uint32_t>& leaf_indices) const;

    /// The six roots come first.
    std::vector<Node> nodes_;
    std::vector<Cell> leaves_;
};

} // namespace relumine::prt
