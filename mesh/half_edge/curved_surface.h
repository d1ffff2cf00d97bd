// The smooth surface that a mesh's normals pretend.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Curved patches over the triangles of a mesh, through their vertices and at right angles to the
/// normals there. Patches of neighbours meet without gaps. Sides that no other triangle has, by the
/// same two vertices, stay straight: rims, and seams and creases, where vertices are doubled.
///
/// Based on: A. Vlachos, J. Peters, C. Boyd, J. L. Mitchell: Curved PN Triangles, 2001.
class CurvedSurface {
public:
    /// The mesh must outlive this object.
    explicit CurvedSurface(const TriangleMesh& mesh);

    /// Returns the point over a point of a triangle, given by the weights of its second and third
    /// corner.
    [[nodiscard]] glm::vec3 at(std::uint32_t triangle, const glm::vec2& weights) const;

private:
    const TriangleMesh& mesh_;
    /// [num_triangles], a bit for each side.
    std::vector<std::uint8_t> straight_;
};

} // namespace relumine::mesh
