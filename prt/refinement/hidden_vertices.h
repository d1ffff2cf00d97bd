// Vertices that another solid hides, and their ways out of it.
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "prt/refinement/lit_surface.h"

namespace relumine::prt {

/// Knows which vertices of a surface may move out of a solid that hides them: new ones where the
/// surface around is flat and goes on to all sides. Their darkness would spread over the triangles
/// beside them.
class HiddenVertices {
public:
    explicit HiddenVertices(LitSurface& surface) : surface_(surface) {}

    /// Looks at the vertices that the last split made. They were traced.
    void find_movable();
    /// Whether a vertex will move along the edge to another one.
    [[nodiscard]] bool moves_to(std::uint32_t hidden, std::uint32_t lit) const;
    /// Ends the work: returns the mesh of the surface with all vertices moved that may, each by the
    /// shortest way to light that turns no triangle over.
    [[nodiscard]] mesh::TriangleMesh moved_out();

private:
    /// From a hidden vertex, along an edge to the first place that light reaches.
    struct Way {
        std::uint32_t vertex, towards;
        /// The last part of the way that is known to be hidden, and the first that is not.
        float hidden = 0.0f, lit = 1.0f;
    };
    [[nodiscard]] std::vector<Way> ways_out();
    static bool move(mesh::TriangleMesh& mesh, const Way& way,
                     const std::vector<std::uint32_t>& triangles);

    LitSurface& surface_;
    /// [num_vertices].
    std::vector<bool> is_movable_;
};

} // namespace relumine::prt
