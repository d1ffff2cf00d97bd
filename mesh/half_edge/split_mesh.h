// A mesh whose edges are split at their middles, without gaps between its triangles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Refines a mesh. Vertices of the beginning keep index and position; new ones follow them. An edge
/// is known by its two places, and vertices at equal positions have one place: so a surface that is
/// cut open at a seam is split on both sides of it.
///
/// A triangle is cut from the middle of its longest side to the corner across, and the halves from
/// there to the middles of the other sides that are split (M.-C. Rivara: Algorithms for refining
/// triangular grids suitable for adaptive and multigrid techniques, 1984; A. Plaza, G. F. Carey:
/// Local refinement of simplicial grids based on the skeleton, 2000). So where any side is split
/// the longest is, and angles do not get ever smaller.
///
/// New vertices lie in the middle of the old edge, with the mean of its colours and uvs and the
/// normal that the triangle of the beginning has there: what it looks like does not change.
class SplitMesh {
public:
    static constexpr std::uint32_t None = 0xffffffff;

    explicit SplitMesh(TriangleMesh mesh);

    [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
    /// Ends the work.
    [[nodiscard]] TriangleMesh take() { return std::move(mesh_); }

    /// Edges are numbered from 0 in the order in which they appear. An edge that was split stays in
    /// the numbering.
    [[nodiscard]] std::size_t num_edges() const { return edges_.size(); }
    [[nodiscard]] bool is_split(std::uint32_t edge) const { return edges_[edge].is_split; }
    [[nodiscard]] float length(std::uint32_t edge) const { return edges_[edge].length; }
    /// Returns the area of the triangles beside an edge. It is 0 where they are void.
    [[nodiscard]] double area_beside(std::uint32_t edge) const;
    /// Returns the edge of a triangle's longest side.
    [[nodiscard]] std::uint32_t longest_edge(std::uint32_t triangle) const {
        return triangle_edges_[triangle][longest_side(triangle)];
    }

    /// A pair of vertices at the ends of an edge. At a seam an edge has several.
    struct Ends {
        std::uint32_t low = 0, high = 0;
        /// A triangle that has it, and whether it is the only one.
        std::uint32_t triangle = 0;
        bool is_rim = false;
    };
    /// Appends the edge's pairs of ends.
    void append_ends(std::uint32_t edge, std::vector<Ends>& ends) const;

    /// Marks an edge for the next split(), and all others that must be split with it. Returns
    /// false, and marks nothing, where that would make more than `most` new vertices in all.
    bool mark(std::uint32_t edge, std::size_t most);
    /// How many vertices split() would add.
    [[nodiscard]] std::size_t num_marked() const { return num_marked_; }
    /// Splits the marked edges.
    void split();

    /// A vertex that the last split() made, and the ends of the edge in whose middle it lies.
    struct Middle {
        std::uint32_t low = 0, high = 0, vertex = 0;
        /// The next pair of the same edge.
        std::uint32_t next = None;
    };
    /// Returns the vertices that the last split() made, ascending.
    [[nodiscard]] std::span<const Middle> new_vertices() const { return middles_; }
    /// Returns the triangles that the last split() made, at the beginning all.
    [[nodiscard]] std::span<const std::uint32_t> changed_triangles() const { return changed_; }

    /// Where a triangle's corners lie on a triangle of the beginning: weights of its second and
    /// third corner.
    struct Origin {
        std::uint32_t triangle = 0;
        std::array<glm::vec2, 3> corners{};
    };
    [[nodiscard]] const Origin& origin(std::uint32_t triangle) const { return origins_[triangle]; }

private:
    struct Edge {
        std::uint32_t low = 0, high = 0;
        /// A side, 3 * triangle + k; the others follow in next_side_.
        std::uint32_t first_side = None;
        float length = 0.0f;
        bool is_split = false, is_marked = false;
        /// While it is being split.
        std::uint32_t first_middle = None;
    };
    /// Edges by their places: a table with open addresses.
    class Table {
    public:
        /// Returns the slot of a pair: None inside, or the number of an edge.
        std::uint32_t& slot(std::uint32_t low, std::uint32_t high);

    private:
        void grow();
        [[nodiscard]] std::size_t find(std::uint64_t key) const;
        std::vector<std::uint64_t> keys_;
        std::vector<std::uint32_t> values_;
        std::size_t num_used_ = 0;
    };

    /// Side k runs from corner k to the next.
    [[nodiscard]] std::uint32_t longest_side(std::uint32_t triangle) const;
    [[nodiscard]] std::uint32_t edge_between(std::uint32_t a, std::uint32_t b);
    void add_sides(std::uint32_t triangle);
    void remove_sides(std::uint32_t triangle);
    void add_middles(std::uint32_t edge);
    [[nodiscard]] std::uint32_t middle(std::uint32_t edge, std::uint32_t a, std::uint32_t b) const;
    void cut(std::uint32_t triangle);
    std::uint32_t cut_in_two(std::uint32_t triangle, std::uint32_t side);

    TriangleMesh mesh_;
    /// [num_vertices], with normals: linear over the triangles of the beginning. Normals are these
    /// at length 1.
    std::vector<glm::vec3> vectors_;
    /// [num_vertices] the first vertex at the position.
    std::vector<std::uint32_t> places_;
    std::vector<Edge> edges_;
    Table table_;
    std::vector<std::array<std::uint32_t, 3>> triangle_edges_;
    /// [3 num_triangles].
    std::vector<std::uint32_t> next_side_;
    std::vector<Origin> origins_;
    std::vector<std::uint32_t> marked_;
    std::size_t num_marked_ = 0;
    /// The middles of the edges that are being split, or were the last time.
    std::vector<Middle> middles_;
    std::vector<std::uint32_t> changed_;
};

} // namespace relumine::mesh
