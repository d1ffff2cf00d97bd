// A bounding volume hierarchy whose nodes have sixteen children, in the layout that vector kernels
// read.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::prt {

/// Triangles sorted into leaves of up to 16, and nodes of up to 16 children above them. Box
/// coordinates are relative to `centre`, in float, each off by at most 2^-24 of `extent`. Triangle
/// corners are exactly the given positions.
struct TriangleTree {
    static constexpr std::size_t Width = 16;

    struct alignas(64) Node {
        /// Boxes of the children: low x, y, z, high x, y, z. An unused lane is an inside-out box,
        /// which is outside of everything.
        std::array<std::array<float, Width>, 6> bounds;
        /// >= 0: index of a node. < 0: leaf ~child.
        std::array<std::int32_t, Width> child;
    };
    struct alignas(64) Leaf {
        /// x, y, z of corners 0, 1, 2. Unused lanes repeat lane 0.
        std::array<std::array<float, Width>, 9> corners;
        /// Largest absolute component of the triangle's edges.
        std::array<float, Width> longest;
        std::uint32_t size = 0;
    };

    /// The root comes first; empty without triangles.
    std::vector<Node> nodes;
    std::vector<Leaf> leaves;
    /// [leaves] numbers of their triangles among the given ones
    std::vector<std::array<std::uint32_t, Width>> triangles;
    glm::vec3 centre{0.0f};
    /// Largest absolute coordinate of the boxes.
    float extent = 0.0f;
};

/// Builds the tree by the surface area heuristic. The same triangles give the same tree.
///
/// centre:  that of the tree; without one it is that of the triangles.
/// Cost:    O(n log n).
[[nodiscard]] TriangleTree triangle_tree(std::span<const glm::vec3> positions,
                                         std::span<const mesh::Triangle> triangles,
                                         const std::optional<glm::vec3>& centre = {});

/// Nodes and leaves of a tree that hang together; the first node is over all others.
struct TreePart {
    std::size_t first_node = 0, end_node = 0, first_leaf = 0, end_leaf = 0;
};
/// Returns all of a tree.
[[nodiscard]] TreePart whole(const TriangleTree& tree);
/// Adds a part of one tree behind another's nodes and leaves. Returns where it is there.
TreePart append(TriangleTree& to, const TriangleTree& from, const TreePart& part);

} // namespace relumine::prt
