// Small meshes of the half-edge tests.
#pragma once

#include "mesh/edge_uses.h"
#include "mesh/normals.h"
#include "tests/mesh/mesh_files.h"

namespace relumine::mesh {

inline TriangleMesh with_normals(TriangleMesh mesh) {
    mesh.normals = smooth_normals(mesh);
    return mesh;
}

/// BoxPositions with twelve triangles that share eight vertices.
inline TriangleMesh box_mesh() {
    TriangleMesh mesh;
    mesh.positions = BoxPositions;
    for (const auto& face : BoxFaces)
        for (std::size_t i = 2; i < face.size(); ++i)
            mesh.triangles.push_back({face[0], face[i - 1], face[i]});
    return with_normals(mesh);
}

/// n x n vertices of a unit square that faces +Y.
inline TriangleMesh sheet(std::uint32_t n) {
    TriangleMesh mesh;
    for (std::uint32_t z = 0; z < n; ++z)
        for (std::uint32_t x = 0; x < n; ++x)
            mesh.positions.emplace_back(static_cast<float>(x) / static_cast<float>(n - 1), 0.0f,
                                        static_cast<float>(z) / static_cast<float>(n - 1));
    for (std::uint32_t z = 0; z + 1 < n; ++z)
        for (std::uint32_t x = 0; x + 1 < n; ++x) {
            const std::uint32_t a = z * n + x, b = a + 1, c = a + n, d = c + 1;
            mesh.triangles.push_back({a, c, b});
            mesh.triangles.push_back({b, c, d});
        }
    return with_normals(mesh);
}

/// A ball of 2 n (n - 1) + 2 vertices.
inline TriangleMesh ball(std::uint32_t n) {
    TriangleMesh mesh;
    constexpr double Pi = 3.14159265358979323846;
    const std::uint32_t columns = 2 * n;
    mesh.positions.emplace_back(0, 1, 0);
    for (std::uint32_t row = 1; row < n; ++row)
        for (std::uint32_t column = 0; column < columns; ++column) {
            const double theta = Pi * row / n, phi = Pi * column / n;
            mesh.positions.emplace_back(std::sin(theta) * std::sin(phi), std::cos(theta),
                                        std::sin(theta) * std::cos(phi));
        }
    mesh.positions.emplace_back(0, -1, 0);
    const auto south = static_cast<std::uint32_t>(mesh.num_vertices() - 1);
    for (std::uint32_t column = 0; column < columns; ++column) {
        const std::uint32_t right = (column + 1) % columns;
        mesh.triangles.push_back({0, 1 + column, 1 + right});
        mesh.triangles.push_back({south, south - columns + right, south - columns + column});
        for (std::uint32_t row = 0; row + 2 < n; ++row) {
            const std::uint32_t a = 1 + row * columns + column, b = 1 + row * columns + right;
            mesh.triangles.push_back({a, a + columns, b});
            mesh.triangles.push_back({b, a + columns, b + columns});
        }
    }
    return with_normals(mesh);
}

/// How many edges have one triangle, two, and more.
inline std::array<std::size_t, 3> edge_counts(std::span<const Triangle> triangles) {
    std::array<std::size_t, 3> counts{};
    for_each_edge(edge_uses(triangles), [&](std::span<const EdgeUse> edge) {
        ++counts[std::min<std::size_t>(edge.size(), 3) - 1];
    });
    return counts;
}

} // namespace relumine::mesh
