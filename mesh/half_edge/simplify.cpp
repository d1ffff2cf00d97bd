#include "mesh/half_edge/simplify.h"

#include <stdexcept>

#include <fmt/format.h>

#include "mesh/half_edge/half_edge_mesh.h"

namespace relumine::mesh {

TriangleMesh simplified(const TriangleMesh& mesh, std::size_t num_vertices, float largest_turn) {
    if (num_vertices < 4)
        throw std::invalid_argument(
            fmt::format("expected at least 4 vertices to keep, got {}", num_vertices));
    HalfEdgeMesh half_edges(mesh, HalfEdgeMesh::Cuts::Attributes);
    half_edges.simplify(num_vertices, largest_turn);
    return half_edges.mesh();
}

} // namespace relumine::mesh
