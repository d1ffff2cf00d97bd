// Triangle mesh: the plain arrays that all other folders use.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "files/plain_glm.h"
#include "mesh/materials/material.h"
#include "mesh/materials/punctual_light.h"
#include "mesh/materials/texture.h"

namespace relumine::mesh {

/// Three indices into TriangleMesh::positions, counter-clockwise seen from outside.
using Triangle = std::array<std::uint32_t, 3>;

/// Indexed triangle mesh. The vertices of the file come first, in its order. Behind them are copies
/// of vertices that have several normals, or colours of faces. Unreferenced vertices, holes and
/// non-manifold edges are kept.
///
/// Axes:    right-handed, +Y up.
/// Unit:    as in the file.
struct TriangleMesh {
    /// [num_vertices], from `offset` on.
    std::vector<glm::vec3> positions;
    /// What was taken off the file's coordinates before they became floats, which far from the
    /// origin round shapes away. Files that are written have it again.
    glm::dvec3 offset{0.0};
    /// [num_triangles], every index < num_vertices.
    std::vector<Triangle> triangles;
    /// [num_vertices] of unit length. Zero for a vertex without a face of positive area.
    std::vector<glm::vec3> normals;
    /// [num_vertices] linear RGB, or empty.
    std::vector<glm::vec3> colors;
    /// [num_vertices], or empty.
    std::vector<glm::vec2> uvs;
    /// [num_vertices], or empty: what textures of the second uv set use.
    std::vector<glm::vec2> second_uvs;
    /// [num_vertices] from each vertex to where its rays start: on the smooth surface that the
    /// normals pretend, or outside of a solid that hides it. Empty: all rays start at the vertices.
    std::vector<glm::vec3> lifts;

    /// [num_triangles], or empty. Used instead of uvs if a vertex has several (seams).
    std::vector<std::array<glm::vec2, 3>> corner_uvs;
    /// [num_triangles], or empty: no normal maps. The direction of growing u, and in w the sign of
    /// the bitangent, sign * cross(normal, tangent); zero without a normal map.
    std::vector<std::array<glm::vec4, 3>> corner_tangents;
    /// In the file's order, or empty.
    std::vector<Material> materials;
    /// [num_triangles], every index < materials.size(); or empty.
    std::vector<std::uint32_t> triangle_materials;
    /// Distinct names of the file's objects or groups, or empty.
    std::vector<std::string> groups;
    /// [num_triangles], every index < groups.size(); or empty.
    std::vector<std::uint32_t> triangle_groups;
    /// Textures of the materials.
    std::vector<Texture> textures;
    /// Lights of the file that have no surface.
    std::vector<PunctualLight> lights;
    /// Material and image files that the file names but that do not exist.
    std::vector<std::string> missing;
    /// What the file holds and the mesh does not, a line each.
    std::vector<std::string> warnings;
    /// How the file was read where that is a choice, a line each.
    std::vector<std::string> notes;

    [[nodiscard]] std::size_t num_vertices() const { return positions.size(); }
    [[nodiscard]] std::size_t num_triangles() const { return triangles.size(); }
};

/// Calls `use` for each array that has a value for every vertex, or is empty.
template<class Mesh, class Use>
void for_each_vertex_array(Mesh& mesh, const Use& use) {
    use(mesh.positions);
    use(mesh.normals);
    use(mesh.colors);
    use(mesh.uvs);
    use(mesh.second_uvs);
    use(mesh.lifts);
}

/// Returns all that a mesh's file holds or names and the mesh does not have, a line each.
[[nodiscard]] std::vector<std::string> left_out(const TriangleMesh& mesh);

/// Throws std::invalid_argument for triangles of vertices that are not there.
///
/// Cost:    O(triangles).
void require_triangles(const TriangleMesh& mesh);

/// Throws std::invalid_argument for arrays of the wrong size, indices of vertices, materials or
/// groups that are not there, positions that are not finite, and normals whose length is neither 1
/// nor 0: for meshes made in code. Readers of files make none of these.
///
/// Cost:    O(vertices + triangles).
void require_consistent(const TriangleMesh& mesh);

/// Axis-aligned box around points.
struct Bounds {
    glm::vec3 min{0.0f};
    glm::vec3 max{0.0f};

    [[nodiscard]] glm::vec3 center() const { return 0.5f * (min + max); }
    [[nodiscard]] glm::vec3 size() const { return max - min; }
    /// Returns the length of the box's diagonal. 0 for a single point.
    [[nodiscard]] float diagonal() const;
};

/// Returns the box around the vertices of the triangles; stray points do not count. A mesh without
/// triangles gets the box around all vertices.
[[nodiscard]] Bounds bounds(const TriangleMesh& mesh);

/// Returns the box around points; one in the origin around none.
[[nodiscard]] Bounds bounds(std::span<const glm::vec3> points);

} // namespace relumine::mesh
