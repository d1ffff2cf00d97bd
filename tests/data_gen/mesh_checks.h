// What the tests ask of generated meshes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::data_gen {

inline glm::dvec3 area_vector(const mesh::TriangleMesh& mesh, const mesh::Triangle& triangle) {
    const glm::dvec3 a(mesh.positions[triangle[0]]);
    const glm::dvec3 b(mesh.positions[triangle[1]]);
    const glm::dvec3 c(mesh.positions[triangle[2]]);
    return 0.5 * glm::cross(b - a, c - a);
}

/// Per vertex, the first vertex at exactly the same place.
inline std::vector<std::uint32_t> welded(const mesh::TriangleMesh& mesh) {
    std::map<std::tuple<float, float, float>, std::uint32_t> first_at;
    std::vector<std::uint32_t> weld;
    for (const glm::vec3& p : mesh.positions) {
        weld.push_back(
            first_at.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(weld.size()))
                .first->second);
    }
    return weld;
}

/// Edges between welded vertices that are not run through once in each direction.
inline std::size_t num_open_edges(const mesh::TriangleMesh& mesh) {
    const std::vector<std::uint32_t> weld = welded(mesh);
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<int, int>> uses;
    for (const mesh::Triangle& triangle : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t from = weld[triangle[k]];
            const std::uint32_t to = weld[triangle[(k + 1) % 3]];
            ++(from < to ? uses[{from, to}].first : uses[{to, from}].second);
        }
    }
    return static_cast<std::size_t>(std::count_if(uses.begin(), uses.end(), [](const auto& edge) {
        return edge.second != std::pair<int, int>(1, 1);
    }));
}

/// Signed volumes of the parts that hang together after welding; positive where triangles face
/// outwards.
inline std::vector<double> volumes(const mesh::TriangleMesh& mesh) {
    std::vector<std::uint32_t> parent = welded(mesh);
    const auto root = [&](std::uint32_t v) {
        while (parent[v] != v) {
            v = parent[v] = parent[parent[v]];
        }
        return v;
    };
    for (const mesh::Triangle& triangle : mesh.triangles) {
        parent[root(triangle[1])] = root(triangle[0]);
        parent[root(triangle[2])] = root(triangle[0]);
    }
    std::map<std::uint32_t, double> volume_of;
    for (const mesh::Triangle& triangle : mesh.triangles) {
        volume_of[root(triangle[0])] +=
            glm::dot(glm::dvec3(mesh.positions[triangle[0]]), area_vector(mesh, triangle)) / 3.0;
    }
    std::vector<double> result;
    result.reserve(volume_of.size());
    for (const auto& [part, volume] : volume_of) {
        result.push_back(volume);
    }
    return result;
}

inline double area(const mesh::TriangleMesh& mesh) {
    return std::accumulate(mesh.triangles.begin(), mesh.triangles.end(), 0.0,
                           [&](double sum, const mesh::Triangle& triangle) {
                               return sum + glm::length(area_vector(mesh, triangle));
                           });
}

} // namespace relumine::data_gen
