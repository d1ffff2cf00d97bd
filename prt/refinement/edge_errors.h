// How much the light in the middle of edges differs from what their ends tell.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/half_edge/split_mesh.h"
#include "prt/refinement/hidden_vertices.h"
#include "prt/refinement/lit_surface.h"

namespace relumine::prt {

/// The errors of a surface's edges (CoarseDirections::difference()). Middles are traced where the
/// ends differ enough, or the edge is long in the scene; until then an edge has a bound.
class EdgeErrors {
public:
    /// Edges shorter than twice `min_edge` are not split. Keeps references.
    EdgeErrors(LitSurface& surface, const HiddenVertices& hidden, const RefineOptions& options);

    /// Finds errors or bounds of the edges that are new, whose ends were traced.
    void add_new_edges();

    struct Candidate {
        /// Error squared times the area beside the edge.
        double weight;
        std::uint32_t edge;
        bool operator<(const Candidate& other) const {
            return weight != other.weight ? weight > other.weight : edge < other.edge;
        }
    };
    /// Returns the edges beyond an error, at most so many, those that matter most first. The error
    /// of each was asked. An edge that has a bound only may stay behind for the next round.
    [[nodiscard]] std::vector<Candidate> beyond(float error, std::size_t most);
    /// Returns the largest that was asked and is beyond an error, or 0.
    [[nodiscard]] float largest_beyond(float error) const;

private:
    /// The pairs of vertices of some edges.
    struct Pair {
        std::uint32_t edge;
        mesh::SplitMesh::Ends ends;
    };
    /// A point inside of a triangle, by the weights of its corners.
    struct Inside {
        std::uint32_t triangle;
        std::array<float, 3> weights;
    };

    [[nodiscard]] bool may_split(std::uint32_t edge) const {
        return is_candidate_[edge] && !surface_.split().is_split(edge);
    }
    [[nodiscard]] Candidate candidate(std::uint32_t edge) const;
    [[nodiscard]] bool is_left_to_move(std::uint32_t edge);
    void bound_new_edges();
    void append_pairs(std::uint32_t edge, std::vector<Pair>& pairs);
    void set_errors(std::span<const Pair> pairs, std::span<const float> errors);
    void ask(std::span<const std::uint32_t> edges);
    void ask_large_triangles();
    void ask_inside(std::span<const Inside> points);

    LitSurface& surface_;
    const HiddenVertices& hidden_;
    float large_, min_edge_;
    bool is_curved_;
    mesh::Bounds subject_;
    /// [num_edges]. Of edges that were not asked, a bound.
    std::vector<float> errors_;
    std::vector<bool> is_asked_, is_candidate_;
    /// Scratch of append_pairs().
    std::vector<mesh::SplitMesh::Ends> ends_;
};

} // namespace relumine::prt
