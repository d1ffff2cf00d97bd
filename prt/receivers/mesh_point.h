// A point of a mesh's surface, and values interpolated there.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::prt {

struct TextureView;

struct MeshPoint {
    std::uint32_t triangle = 0;
    /// Weights of the triangle's second and third vertex; each >= 0, their sum <= 1.
    glm::vec2 barycentric{0.0f};
    bool operator==(const MeshPoint&) const = default;
};

/// Interpolates a vertex attribute at a point, linearly within its triangle.
///
/// Shape:   values is [num_vertices].
[[nodiscard]] glm::vec3 value_at(const mesh::TriangleMesh& mesh, std::span<const glm::vec3> values,
                                 const MeshPoint& point);

/// Returns the sides of its triangle that a point lies on: bit k for the side across from corner k.
[[nodiscard]] unsigned sides_at(const mesh::TriangleMesh& mesh, const MeshPoint& point);

/// Returns the point moved off some sides of its triangle, to `step` inside of it. On a side it
/// would lie in the plane of a surface that meets the triangle there, and look past it.
[[nodiscard]] MeshPoint off_sides(const mesh::TriangleMesh& mesh, const MeshPoint& point,
                                  unsigned sides, float step);

/// Returns the mesh's uv at a point, of a set; 0 where it has none.
[[nodiscard]] glm::vec2 uv_at(const mesh::TriangleMesh& mesh, const MeshPoint& point,
                              std::uint32_t uv_set);

/// Returns the unit normal of a triangle, or zero for a triangle without area. The corners run
/// counter-clockwise as seen from the normal's tip.
[[nodiscard]] glm::vec3 face_normal(const mesh::TriangleMesh& mesh, std::uint32_t triangle);

/// Returns the interpolated vertex normal with unit length, or the face's normal where the vertex
/// normals cancel.
[[nodiscard]] glm::vec3 shading_normal(const mesh::TriangleMesh& mesh, const MeshPoint& point);

/// Returns the unit tangent of the triangle's corners at a point, across its shading_normal(), with
/// the bitangent's sign in w. Of length 0 where the material needs none.
[[nodiscard]] glm::vec4 tangent_at(const mesh::TriangleMesh& mesh, const MeshPoint& point);

/// Returns the unit normal that the material's normal map gives a point: shading_normal() where it
/// has none, or where it is flat.
[[nodiscard]] glm::vec3 mapped_normal(const mesh::TriangleMesh& mesh, const MeshPoint& point);

/// The mean of the normals that a sample of a picture stands for.
struct MappedNormal {
    /// Unit length.
    glm::vec3 direction;
    /// Mean square of their differences from the mean: 0 where all are equal.
    float spread = 0.0f;
};

/// Returns mapped_normal() over what a sample of a view sees of the map; without a view, at the
/// point.
[[nodiscard]] MappedNormal seen_normal(const mesh::TriangleMesh& mesh, const MeshPoint& point,
                                       const TextureView* view);

/// Returns the same of the material's clear coat.
[[nodiscard]] MappedNormal seen_coat_normal(const mesh::TriangleMesh& mesh, const MeshPoint& point,
                                            const TextureView* view);

/// Returns the point moved outwards to the smooth surface that the vertex normals pretend. Shadow
/// rays that start there do not see the facets of a convex mesh where the light grazes it. Points
/// of flat and hollow parts stay where they are, and so do those beside a sharp edge. Lifts of
/// the vertices come on top.
///
/// Based on: J. Hanika, "Hacking the Shadow Terminator", Ray Tracing Gems II, 2021.
[[nodiscard]] glm::vec3 smooth_position(const mesh::TriangleMesh& mesh, const MeshPoint& point);

/// Whether a vertex's lift leads along its surface, out of a solid that hides it. All others lead
/// to the smooth surface, or back from what touches the vertex.
[[nodiscard]] bool leads_along(const glm::vec3& lift, const glm::vec3& normal);

/// Returns `count` points of the surface chosen at random, evenly by area; none for a mesh without
/// an area. The same seed gives the same points. They are sorted by triangle.
///
/// Cost:    O(triangles + count log triangles).
[[nodiscard]] std::vector<MeshPoint> random_points(const mesh::TriangleMesh& mesh,
                                                   std::size_t count, std::uint64_t seed);

/// Whether a ray meets the front of a surface: the side of the triangle that its vertex normals
/// stand on. Interpolated normals alone would show some fronts to rays from behind.
[[nodiscard]] bool meets_front(const mesh::TriangleMesh& mesh, const MeshPoint& point,
                               const glm::vec3& direction);

} // namespace relumine::prt
