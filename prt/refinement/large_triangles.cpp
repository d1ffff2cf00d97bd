#include "prt/refinement/large_triangles.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace relumine::prt {

float longest_side(const mesh::TriangleMesh& mesh, const mesh::Triangle& triangle) {
    const auto& [a, b, c] = triangle;
    const std::vector<glm::vec3>& at = mesh.positions;
    return std::max(
        {glm::distance(at[a], at[b]), glm::distance(at[b], at[c]), glm::distance(at[c], at[a])});
}

float large_side(const mesh::TriangleMesh& mesh) {
    constexpr float PartOfDiagonal = 1.0f / 24.0f;
    return PartOfDiagonal * mesh::bounds(mesh).diagonal();
}

std::vector<glm::vec2> points_inside(float side) {
    // The centres of the k x k triangles that parallels to the sides cut it into.
    constexpr float MostParts = 24.0f;
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

} // namespace relumine::prt
