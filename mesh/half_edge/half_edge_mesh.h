// Half-edges of a mesh: who is next to whom. OpenMesh is inside.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// A mesh with half-edges. Each vertex of the structure is one fan of triangles: where an edge has
/// more than two triangles, or two that go the same way, the surface is cut open there, and a
/// vertex of several fans becomes several. mesh() joins them again.
class HalfEdgeMesh {
public:
    /// Where the surface is cut open.
    enum class Cuts {
        /// Only where half-edges cannot hold it. Vertices at equal positions count as one.
        Shape,
        /// Also along seams of uvs and borders of materials and groups, so that each fan has one
        /// value of each attribute. Vertices are those of the mesh.
        Attributes,
    };

    /// `mesh` must outlive this object. Triangles that have a vertex twice are left out, and so are
    /// those with the same vertices as an earlier one.
    HalfEdgeMesh(const TriangleMesh& mesh, Cuts cuts);
    ~HalfEdgeMesh();
    HalfEdgeMesh(HalfEdgeMesh&&) noexcept;
    HalfEdgeMesh& operator=(HalfEdgeMesh&&) noexcept;

    /// A corner of the rim of a hole.
    struct RimCorner {
        /// A vertex of the mesh.
        std::uint32_t vertex = 0;
        /// The triangle at the side from this corner to the next, and its corner here.
        std::uint32_t triangle = 0;
        std::uint32_t corner = 0;
        /// Other fans have the vertex, too.
        bool is_cut = false;
    };

    /// Returns the rims of all holes, each once around so that triangles of its corners in this
    /// order continue the surface.
    [[nodiscard]] std::vector<std::vector<RimCorner>> rims() const;

    /// Removes vertices by collapsing half-edges, the cheapest in the error of quadrics first,
    /// until so many vertices have triangles (M. Garland, P. S. Heckbert: Surface Simplification
    /// Using Quadric Error Metrics, 1997). The vertices that stay keep their places. Vertices of
    /// rims and cuts stay, and no triangle turns by more than `largest_turn` degrees.
    void simplify(std::size_t num_vertices, float largest_turn);

    /// Returns the mesh of the present triangles, with all attributes. Vertices without triangles
    /// are left out if they had some; the others keep their order.
    [[nodiscard]] TriangleMesh mesh() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace relumine::mesh
