// Vertices that another solid hides, and their ways out of it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "prt/refinement/lit_surface.h"

namespace relumine::prt {

/// Keeps the darkness of vertices that a solid hides from the triangles beside them. New vertices
/// move out of the solid where the surface around them is flat and goes on to all sides. All others
/// stay, and look from outside of it.
class HiddenVertices {
public:
    explicit HiddenVertices(LitSurface& surface) : surface_(surface) {}

    /// Looks at the vertices that the last split made. They were traced.
    void find_movable();
    /// Whether a vertex will move along the edge to another one.
    [[nodiscard]] bool moves_to(std::uint32_t hidden, std::uint32_t lit) const;
    /// Whether both ends of an edge are hidden, in one of its pairs.
    [[nodiscard]] bool hides_ends(std::span<const mesh::SplitMesh::Ends> edge) const;
    /// Ends the work: returns the mesh of the surface with all vertices moved that may, each by the
    /// shortest way to light that turns no triangle over. Others get lifts along such ways.
    [[nodiscard]] mesh::TriangleMesh moved_out();

private:
    /// From a hidden vertex, along an edge to the first place that light reaches.
    struct Way {
        std::uint32_t vertex, towards;
        /// The last part of the way that is known to be hidden, and the first that is not.
        float hidden = 0.0f, lit = 1.0f;
        /// Directions whose light reaches these two places.
        int num_hidden, num_lit;
        /// Light begins at once outside of a solid. In a cranny it grows along the way.
        [[nodiscard]] bool leaves_a_solid() const { return 4 * num_hidden < num_lit; }
    };
    [[nodiscard]] bool is_hidden(std::uint32_t vertex) const {
        return CoarseDirections::is_hidden(surface_.bits(vertex));
    }
    [[nodiscard]] std::vector<Way> ways_out();
    void leave_gaps(std::vector<Way>& ways);
    [[nodiscard]] std::vector<int> num_lit_at(std::span<const Way> ways,
                                              std::span<const float> parts);
    [[nodiscard]] bool passes_a_sheet(const Way& way) const;
    static void look_from_the_end(mesh::TriangleMesh& mesh, const Way& way);
    static bool move(mesh::TriangleMesh& mesh, const Way& way,
                     const std::vector<std::uint32_t>& triangles);

    LitSurface& surface_;
    /// [num_vertices].
    std::vector<bool> is_movable_;
};

} // namespace relumine::prt
