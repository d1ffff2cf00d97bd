// A point of a mesh's surface, and what its triangle's vertices say there.
#pragma once

#include <cstdint>
#include <span>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::prt {

struct MeshPoint {
    std::uint32_t triangle = 0;
    /// Weights of the triangle's second and third vertex, >= 0, sum <= 1
    glm::vec2 barycentric{0.0f};
    bool operator==(const MeshPoint&) const = default;
};

/// A vertex attribute [num_vertices] at a point, linear within its triangle.
[[nodiscard]] glm::vec3 value_at(const mesh::TriangleMesh& mesh, std::span<const glm::vec3> values,
                                 const MeshPoint& point);

/// Unit normal of a triangle, counter-clockwise seen from its tip; zero for one without an area.
[[nodiscard]] glm::vec3 face_normal(const mesh::TriangleMesh& mesh, std::uint32_t triangle);

/// The vertices' normals interpolated, unit length; the face's where they cancel.
[[nodiscard]] glm::vec3 shading_normal(const mesh::TriangleMesh& mesh, const MeshPoint& point);

} // namespace relumine::prt
