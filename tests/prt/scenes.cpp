#include "tests/prt/scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>

#include "mesh/normals.h"

namespace relumine::scenes {

mesh::TriangleMesh floor_grid(std::uint32_t n, float side, float height) {
    mesh::TriangleMesh mesh;
    for (std::uint32_t z = 0; z < n; ++z)
        for (std::uint32_t x = 0; x < n; ++x) {
            const auto at = [&](std::uint32_t i) {
                return side * (static_cast<float>(i) / static_cast<float>(n - 1) - 0.5f);
            };
            mesh.positions.emplace_back(at(x), height, at(z));
            mesh.normals.emplace_back(0.0f, 1.0f, 0.0f);
        }
    for (std::uint32_t z = 0; z + 1 < n; ++z)
        for (std::uint32_t x = 0; x + 1 < n; ++x) {
            const std::uint32_t i = z * n + x;
            mesh.triangles.push_back({i, i + n, i + n + 1});
            mesh.triangles.push_back({i, i + n + 1, i + 1});
        }
    return mesh;
}

mesh::TriangleMesh icosphere(std::uint32_t level, float radius, const glm::vec3& centre) {
    const float g = std::numbers::phi_v<float>;
    std::vector<glm::vec3> points = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                     {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                     {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    std::vector<mesh::Triangle> triangles = {
        {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
        {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
        {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (glm::vec3& point : points)
        point = glm::normalize(point);
    for (std::uint32_t step = 0; step < level; ++step) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> midpoints;
        const auto midpoint = [&](std::uint32_t a, std::uint32_t b) {
            const auto [entry, is_new] =
                midpoints.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
            if (is_new)
                points.push_back(glm::normalize(points[a] + points[b]));
            return entry->second;
        };
        std::vector<mesh::Triangle> finer;
        for (const auto& [a, b, c] : triangles) {
            const std::uint32_t ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        triangles = std::move(finer);
    }
    mesh::TriangleMesh mesh;
    mesh.triangles = std::move(triangles);
    mesh.normals = points;
    for (const glm::vec3& point : points)
        mesh.positions.push_back(centre + radius * point);
    return mesh;
}

mesh::TriangleMesh box(const glm::vec3& low, const glm::vec3& high) {
    mesh::TriangleMesh mesh;
    for (std::uint32_t i = 0; i < 8; ++i) {
        const bool x = (i & 1u) != 0, y = (i & 2u) != 0, z = (i & 4u) != 0;
        mesh.positions.emplace_back(x ? high.x : low.x, y ? high.y : low.y, z ? high.z : low.z);
        mesh.normals.push_back(
            glm::normalize(glm::vec3(x ? 1.0f : -1.0f, y ? 1.0f : -1.0f, z ? 1.0f : -1.0f)));
    }
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 4, 6}, {0, 6, 2},
                      {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3}};
    return mesh;
}

mesh::TriangleMesh joined(const mesh::TriangleMesh& first, const mesh::TriangleMesh& second) {
    mesh::TriangleMesh mesh = first;
    const auto offset = static_cast<std::uint32_t>(first.num_vertices());
    mesh.positions.insert(mesh.positions.end(), second.positions.begin(), second.positions.end());
    mesh.normals.insert(mesh.normals.end(), second.normals.begin(), second.normals.end());
    for (const auto& [a, b, c] : second.triangles)
        mesh.triangles.push_back({a + offset, b + offset, c + offset});
    return mesh;
}

mesh::TriangleMesh triangle_soup(std::size_t num_triangles, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> coordinate(-1.0f, 1.0f);
    std::uniform_real_distribution<float> edge(-0.4f, 0.4f);
    mesh::TriangleMesh mesh;
    for (std::uint32_t i = 0; i < num_triangles; ++i) {
        const glm::vec3 corner(coordinate(random), coordinate(random), coordinate(random));
        mesh.positions.push_back(corner);
        mesh.positions.push_back(corner + glm::vec3(edge(random), edge(random), edge(random)));
        mesh.positions.push_back(corner + glm::vec3(edge(random), edge(random), edge(random)));
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return mesh;
}

mesh::TriangleMesh sphere_and_box_on_floor() {
    mesh::TriangleMesh slanted = box({-0.3f, -0.2f, -0.5f}, {0.3f, 0.2f, 0.5f});
    for (std::vector<glm::vec3>* vectors : {&slanted.positions, &slanted.normals})
        for (glm::vec3& v : *vectors)
            v = {0.8f * v.x - 0.6f * v.y, 0.6f * v.x + 0.8f * v.y, v.z};
    for (glm::vec3& position : slanted.positions)
        position += glm::vec3(-0.8f, 0.6f, 0.2f);
    return joined(joined(floor_grid(11, 4.0f), icosphere(2, 0.5f, {0.5f, 0.55f, -0.1f})), slanted);
}

glm::vec3 random_direction(std::mt19937& random) {
    std::normal_distribution<double> normal;
    return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
}

std::vector<bool> random_split_flags(std::mt19937& random, std::uint32_t max_level,
                                     double probability) {
    std::bernoulli_distribution splits(probability);
    std::vector<bool> flags;
    const auto grow = [&](const auto& self, std::uint32_t level) -> void {
        const bool split = level < max_level && splits(random);
        flags.push_back(split);
        for (int i = 0; split && i < 4; ++i)
            self(self, level + 1);
    };
    for (std::size_t face = 0; face < cubemap::NumFaces; ++face)
        grow(grow, 0);
    return flags;
}

glm::dvec3 vector_irradiance_of_white(cubemap::Face face, double s0, double t0, double s1,
                                      double t1) {
    const std::array<glm::dvec3, 4> corners = {
        cubemap::direction(face, s0, t0), cubemap::direction(face, s1, t0),
        cubemap::direction(face, s1, t1), cubemap::direction(face, s0, t1)};
    glm::dvec3 sum(0.0);
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::dvec3 across = glm::cross(corners[i], corners[(i + 1) % 4]);
        const double sine = glm::length(across);
        sum += 0.5 * std::atan2(sine, glm::dot(corners[i], corners[(i + 1) % 4])) / sine * across;
    }
    // The sense of rotation is the face's; the light comes from its middle.
    return glm::dot(sum, cubemap::direction(face, 0.5 * (s0 + s1), 0.5 * (t0 + t1))) > 0.0 ? sum
                                                                                           : -sum;
}

glm::dvec3 vector_irradiance_of_white(const prt::Cell& cell) {
    const double size = cell.size();
    return vector_irradiance_of_white(cell.face, cell.x * size, cell.y * size, (cell.x + 1) * size,
                                      (cell.y + 1) * size);
}

mesh::TriangleMesh transformed(mesh::TriangleMesh mesh, float scale, const glm::vec3& offset) {
    for (glm::vec3& position : mesh.positions)
        position = scale * position + offset;
    return mesh;
}

} // namespace relumine::scenes
