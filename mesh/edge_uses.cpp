#include "mesh/edge_uses.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <tuple>

#include <glm/geometric.hpp>

namespace relumine::mesh {

std::vector<EdgeUse> edge_uses(std::span<const Triangle> triangles) {
    if (triangles.size() > 0xffffffffu / 3)
        throw std::invalid_argument("expected at most 2^32 / 3 triangles");
    std::vector<EdgeUse> uses;
    uses.reserve(3 * triangles.size());
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
        const auto& [a, b, c] = triangles[i];
        if (a == b || b == c || c == a)
            continue;
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t from = triangles[i][k], to = triangles[i][(k + 1) % 3];
            uses.push_back({std::min(from, to), std::max(from, to), 3 * i + k, from < to});
        }
    }
    std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
        return std::tie(a.low, a.high, a.corner) < std::tie(b.low, b.high, b.corner);
    });
    return uses;
}

std::vector<std::uint32_t> first_at_place(std::span<const glm::vec3> positions) {
    std::vector<std::uint32_t> order(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto less = [&](std::uint32_t a, std::uint32_t b) {
        const glm::vec3 &p = positions[a], &q = positions[b];
        return std::tie(p.x, p.y, p.z, a) < std::tie(q.x, q.y, q.z, b);
    };
    std::sort(order.begin(), order.end(), less);
    std::vector<std::uint32_t> first(positions.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        first[order[i]] = i > 0 && positions[order[i]] == positions[order[i - 1]]
                              ? first[order[i - 1]]
                              : order[i];
    return first;
}

std::vector<Triangle> renamed(std::span<const Triangle> triangles,
                              std::span<const std::uint32_t> names) {
    std::vector<Triangle> result;
    result.reserve(triangles.size());
    for (const auto& [a, b, c] : triangles)
        result.push_back({names[a], names[b], names[c]});
    return result;
}

DisjointSets::DisjointSets(std::size_t size) : parents_(size) {
    std::iota(parents_.begin(), parents_.end(), 0u);
}

std::uint32_t DisjointSets::first(std::uint32_t item) {
    while (parents_[item] != item)
        item = parents_[item] = parents_[parents_[item]];
    return item;
}

void DisjointSets::join(std::uint32_t a, std::uint32_t b) {
    a = first(a);
    b = first(b);
    parents_[std::max(a, b)] = std::min(a, b);
}

glm::dvec3 area_normal(std::span<const glm::vec3> positions, const Triangle& triangle) {
    const glm::dvec3 origin(positions[triangle[0]]);
    return glm::cross(glm::dvec3(positions[triangle[1]]) - origin,
                      glm::dvec3(positions[triangle[2]]) - origin);
}

} // namespace relumine::mesh
