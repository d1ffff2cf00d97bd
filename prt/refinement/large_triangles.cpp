#include "prt/refinement/large_triangles.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "mesh/subject.h"

namespace relumine::prt {

float longest_side(const mesh::TriangleMesh& mesh, const mesh::Triangle& triangle) {
    const auto& [a, b, c] = triangle;
    const std::vector<glm::vec3>& at = mesh.positions;
    return std::max(
        {glm::distance(at[a], at[b]), glm::distance(at[b], at[c]), glm::distance(at[c], at[a])});
}

float large_side(const mesh::TriangleMesh& mesh) {
    constexpr float PartOfDiagonal = 1.0f / 24.0f;
    return PartOfDiagonal * mesh::scale(mesh);
}

std::vector<glm::vec2> points_inside(float side) {
    // The centres of the k x k triangles that parallels to the sides cut it into.
    const auto k = static_cast<std::uint32_t>(std::ceil(std::clamp(side, 1.0f, MostParts)));
    std::vector<glm::vec2> points;
    const auto add = [&](std::uint32_t i, std::uint32_t j, float part) {
        points.emplace_back((static_cast<float>(i) + part) / static_cast<float>(k),
                            (static_cast<float>(j) + part) / static_cast<float>(k));
    };
    for (std::uint32_t i = 0; i < k; ++i)
        for (std::uint32_t j = 0; i + j < k; ++j) {
            add(i, j, 1.0f / 3.0f);
            if (i + j + 1 < k)
                add(i, j, 2.0f / 3.0f);
        }
    return points;
}

std::vector<glm::vec2> points_near(const mesh::TriangleMesh& mesh, const mesh::Triangle& triangle,
                                   const mesh::Bounds& box) {
    constexpr int Half = 3; // of the points on a side
    const glm::dvec3 origin(mesh.positions[triangle[0]]);
    const glm::dvec3 u = glm::dvec3(mesh.positions[triangle[1]]) - origin;
    const glm::dvec3 v = glm::dvec3(mesh.positions[triangle[2]]) - origin;
    const glm::dvec3 normal = glm::cross(u, v);
    const double square = glm::dot(normal, normal);
    std::vector<glm::vec2> points;
    if (!(square > 0.0))
        return points;
    const double step = double{box.diagonal()} / (2 * Half);
    const glm::dvec3 right = step * glm::normalize(u);
    const glm::dvec3 up = step * glm::normalize(glm::cross(normal, u));
    for (int i = -Half; i <= Half; ++i)
        for (int j = -Half; j <= Half; ++j) {
            const glm::dvec3 at = glm::dvec3(box.center()) + static_cast<double>(i) * right +
                                  static_cast<double>(j) * up - origin;
            const double second = glm::dot(glm::cross(at, v), normal) / square;
            const double third = glm::dot(glm::cross(u, at), normal) / square;
            if (second > 0.0 && third > 0.0 && second + third < 1.0)
                points.emplace_back(second, third);
        }
    return points;
}

} // namespace relumine::prt
