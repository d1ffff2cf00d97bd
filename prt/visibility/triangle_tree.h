// A bounding volume hierarchy whose nodes have sixteen children, in the layout that vector kernels
// read.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::prt {

/// Triangles sorted into leaves of up to 16, and nodes of up to 16 children above them. The boxes'
/// coordinates are relative to `centre`, in float: each is off by at most 2^-24 of `extent`. The
/// triangles' are those given.
struct TriangleTree {
    static constexpr std::size_t Width = 16;

    struct alignas(64) Node {
        /// Boxes of the children: low x, y, z, high x, y, z. An unused lane is an inside-out box,
        /// which is outside of everything.
        std::array<std::array<float, Width>, 6> bounds;
        /// >= 0: that node; < 0: leaf ~child
        std::array<std::int32_t, Width> child;
    };
    struct alignas(64) Leaf {
        /// x, y, z of corners 0, 1, 2; unused lanes repeat lane 0
        std::array<std::array<float, Width>, 9> corners;
        /// Largest component of the triangle's edges
        std::array<float, Width> longest;
        std::uint32_t size = 0;
    };

    /// The root first; empty where there are no triangles
    std::vector<Node> nodes;
    std::vector<Leaf> leaves;
    glm::vec3 centre{0.0f};
    /// Largest coordinate
    float extent = 0.0f;
};

/// Splits where the surface area heuristic says. The same tree for the same triangles. O(n log n).
[[nodiscard]] TriangleTree triangle_tree(std::span<const glm::vec3> positions,
                                         std::span<const mesh::Triangle> triangles);

} // namespace relumine::prt
