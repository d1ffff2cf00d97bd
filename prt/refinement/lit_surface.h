// A mesh that is being refined, and what light reaches the points of its surface.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/half_edge/split_mesh.h"
#include "prt/receivers/receivers.h"
#include "prt/refinement/coarse_transfer.h"
#include "prt/refinement/refine.h"
#include "prt/steps.h"
#include "prt/visibility/blockers.h"

namespace relumine::prt {

/// The vertices of a mesh::SplitMesh with the bits of CoarseDirections and the light of lamps.
/// Vertices alone are traced that belong to triangles to be refined (RefineOptions::coarse_edge).
/// Rays of new vertices start on the smooth surface over the mesh of the beginning, unless the mesh
/// will be curved.
class LitSurface {
public:
    using Bits = CoarseDirections::Bits;
    using Neighbours = CoarseDirections::Neighbours;

    /// Keeps references to the mesh, the blockers, the options and the progress.
    LitSurface(const mesh::TriangleMesh& base, const Blockers& blockers,
               const RefineOptions& options, const Progress& progress);

    [[nodiscard]] mesh::SplitMesh& split() { return split_; }
    [[nodiscard]] const mesh::SplitMesh& split() const { return split_; }
    [[nodiscard]] const mesh::TriangleMesh& mesh() const { return split_.mesh(); }
    [[nodiscard]] const CoarseDirections& directions() const { return directions_; }
    [[nodiscard]] const Blockers& blockers() const { return blockers_; }
    [[nodiscard]] float bias() const { return bias_; }
    /// Points that were traced so far.
    [[nodiscard]] std::size_t num_points() const { return num_points_; }

    /// Finds what reaches the vertices that are not known yet.
    void trace_vertices();
    [[nodiscard]] bool is_traced(std::uint32_t vertex) const {
        return vertex < is_traced_.size() && is_traced_[vertex];
    }
    [[nodiscard]] const Bits& bits(std::uint32_t vertex) const { return vertex_bits_[vertex]; }
    [[nodiscard]] CoarseDirections::Point vertex(std::uint32_t index, float weight = 1.0f) const {
        return {mesh().normals[index], &vertex_bits_[index], weight, vertex_lamps_[index]};
    }
    /// Returns the way from a vertex to the smooth surface.
    [[nodiscard]] const glm::vec3& lift(std::uint32_t vertex) const { return lifts_[vertex]; }
    /// Returns what the ends of an edge tell of its middle.
    [[nodiscard]] Neighbours neighbours(std::uint32_t low, std::uint32_t high) const;

    /// Adds a point with the weighted mean of vertices' positions and normals.
    void add_mean(std::span<const std::uint32_t> vertices, std::span<const float> weights,
                  Receivers& receivers) const;
    /// Adds the point with these weights of a triangle's corners on its smooth surface.
    void add_inside(std::uint32_t triangle, const std::array<float, 3>& weights,
                    Receivers& receivers) const;
    /// The middle of an edge, on a rim a little inside of it.
    void add_middle(const mesh::SplitMesh::Ends& ends, Receivers& receivers) const;

    [[nodiscard]] std::vector<Bits> trace(const Receivers& receivers,
                                          std::span<const Neighbours> neighbours = {});

    /// Returns what lamps give to points, [receivers], in parts of the mean of the first points
    /// that any of it reached.
    [[nodiscard]] std::vector<float> lamps_at(const Receivers& receivers);

    /// Returns the mesh with the ways to the smooth surface. Ends the work.
    [[nodiscard]] mesh::TriangleMesh take();

private:
    [[nodiscard]] std::vector<std::uint32_t> vertices_to_trace();
    void lift_new_vertices();
    [[nodiscard]] glm::vec3 lift_at(std::uint32_t triangle,
                                    const std::array<float, 3>& weights) const;
    void move_inside(std::uint32_t triangle, glm::vec3& position) const;

    const mesh::TriangleMesh& base_;
    const Blockers& blockers_;
    const RefineOptions& options_;
    const Progress& progress_;
    mesh::SplitMesh split_;
    CoarseDirections directions_;
    float step_, bias_, fine_;
    bool is_curved_;
    std::size_t num_points_ = 0;
    /// [num_triangles of the beginning].
    std::vector<bool> is_refined_;
    /// [num_vertices].
    std::vector<Bits> vertex_bits_;
    std::vector<bool> is_traced_;
    std::vector<float> vertex_lamps_;
    std::vector<glm::vec3> lifts_;
    /// The mean over the first points that any lamp reached; 0 until then.
    float mean_of_lamps_ = 0.0f;
};

} // namespace relumine::prt
