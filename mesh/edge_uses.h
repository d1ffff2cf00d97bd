// The edges of a mesh and the triangles beside them, of any mesh: also where more than two meet.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// One side of a triangle. Corner c is corner c % 3 of triangle c / 3; its side runs from there to
/// the triangle's next corner.
struct EdgeUse {
    std::uint32_t low = 0, high = 0;
    std::uint32_t corner = 0;
    /// The triangle goes from `low` to `high`.
    bool ascends = false;

    [[nodiscard]] std::uint32_t triangle() const { return corner / 3; }
    [[nodiscard]] bool same_edge(const EdgeUse& other) const {
        return low == other.low && high == other.high;
    }
};

/// Returns the sides of all triangles with three different corners. Sides of one edge follow each
/// other, by corner.
///
/// Throws:  std::invalid_argument for more than 2^32 / 3 triangles.
/// Cost:    O(n log n).
[[nodiscard]] std::vector<EdgeUse> edge_uses(std::span<const Triangle> triangles);

/// Calls visit(uses) for each edge.
template<typename Visit>
void for_each_edge(std::span<const EdgeUse> uses, const Visit& visit) {
    for (std::size_t begin = 0; begin < uses.size();) {
        std::size_t end = begin + 1;
        while (end < uses.size() && uses[end].same_edge(uses[begin]))
            ++end;
        visit(uses.subspan(begin, end - begin));
        begin = end;
    }
}

/// Whether an edge joins two triangles as in a surface: two sides that run against each other.
[[nodiscard]] inline bool is_smooth_join(std::span<const EdgeUse> edge) {
    return edge.size() == 2 && edge[0].ascends != edge[1].ascends;
}

/// Returns for each vertex the first vertex at the same position.
///
/// Shape:   [num_vertices].
/// Cost:    O(n log n).
[[nodiscard]] std::vector<std::uint32_t> first_at_place(std::span<const glm::vec3> positions);

/// Returns the triangles with these vertices in place of their own: names is [num_vertices].
[[nodiscard]] std::vector<Triangle> renamed(std::span<const Triangle> triangles,
                                            std::span<const std::uint32_t> names);

/// Sets of items that are joined pair by pair.
class DisjointSets {
public:
    explicit DisjointSets(std::size_t size);
    /// Returns the smallest item of the set.
    [[nodiscard]] std::uint32_t first(std::uint32_t item);
    void join(std::uint32_t a, std::uint32_t b);

private:
    std::vector<std::uint32_t> parents_;
};

/// Returns the normal of a triangle, twice its area long.
[[nodiscard]] glm::dvec3 area_normal(std::span<const glm::vec3> positions,
                                     const Triangle& triangle);

} // namespace relumine::mesh
