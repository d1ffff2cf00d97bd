// Triangle mesh: the plain arrays that every other folder works on.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/material.h"
#include "mesh/texture.h"

namespace relumine::mesh {

/// Three indices into TriangleMesh::positions, counter-clockwise seen from outside.
using Triangle = std::array<std::uint32_t, 3>;

/// Indexed triangle mesh. Count and order of the vertices are those of the file; unreferenced
/// vertices, holes and non-manifold edges are kept. World axes: right-handed, +Y up; units are the
/// file's own.
struct TriangleMesh {
    /// [num_vertices]
    std::vector<glm::vec3> positions;
    /// [num_triangles], every index < num_vertices
    std::vector<Triangle> triangles;
    /// [num_vertices], unit length, or zero where a vertex has no face with an area
    std::vector<glm::vec3> normals;
    /// [num_vertices] linear RGB, or empty
    std::vector<glm::vec3> colors;
    /// [num_vertices], or empty
    std::vector<glm::vec2> uvs;

    /// [num_triangles], instead of uvs where a vertex has several (seams); or empty
    std::vector<std::array<glm::vec2, 3>> corner_uvs;
    /// In the file's order, or empty
    std::vector<Material> materials;
    /// [num_triangles], every one < materials.size(); or empty
    std::vector<std::uint32_t> triangle_materials;
    /// Names of the file's objects or groups, distinct; or empty
    std::vector<std::string> groups;
    /// [num_triangles], every one < groups.size(); or empty
    std::vector<std::uint32_t> triangle_groups;
    /// Of the materials
    std::vector<Texture> textures;
    /// Material and image files that the file names and that are not there
    std::vector<std::string> missing;

    [[nodiscard]] std::size_t num_vertices() const { return positions.size(); }
    [[nodiscard]] std::size_t num_triangles() const { return triangles.size(); }
};

/// Axis-aligned box around points.
struct Bounds {
    glm::vec3 min{0.0f};
    glm::vec3 max{0.0f};

    [[nodiscard]] glm::vec3 center() const { return 0.5f * (min + max); }
    [[nodiscard]] glm::vec3 size() const { return max - min; }
    /// Length of the box's diagonal, 0 for a single point.
    [[nodiscard]] float diagonal() const;
};

/// Box around the vertices that some triangle uses (stray points do not count); around all where
/// there is no triangle.
[[nodiscard]] Bounds bounds(const TriangleMesh& mesh);

} // namespace relumine::mesh
