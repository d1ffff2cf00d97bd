#include "prt/visibility/coplanar_faces.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "mesh/edge_uses.h"

namespace relumine::prt {

void CoplanarFaces::find_surfaces() const {
    mesh::DisjointSets sets(positions_.size());
    for (const mesh::Triangle& triangle : triangles_) {
        sets.join(triangle[0], triangle[1]);
        sets.join(triangle[1], triangle[2]);
    }
    constexpr std::uint32_t None = ~std::uint32_t{0};
    std::vector<std::uint32_t> first(positions_.size(), None);
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
        std::uint32_t& own = first[sets.first(triangles_[i][0])];
        own = std::min(own, i);
    }
    begins_.resize(positions_.size());
    for (std::uint32_t vertex = 0; vertex < begins_.size(); ++vertex)
        begins_[vertex] = first[sets.first(vertex)];
}

bool CoplanarFaces::covers(std::uint32_t triangle, std::uint32_t other) const {
    std::call_once(is_found_, [this] { find_surfaces(); });
    return begins_[triangles_[triangle][0]] < begins_[triangles_[other][0]] &&
           are_coplanar(triangle, other);
}

/// Whether the corners of the smaller one lie in the plane of the larger one, but for the roundings
/// of coordinates.
bool CoplanarFaces::are_coplanar(std::uint32_t a, std::uint32_t b) const {
    constexpr double Roundings = 8.0 * std::numeric_limits<float>::epsilon();
    glm::dvec3 normal = mesh::area_normal(positions_, triangles_[a]);
    const glm::dvec3 other = mesh::area_normal(positions_, triangles_[b]);
    if (glm::dot(normal, normal) < glm::dot(other, other)) {
        std::swap(a, b);
        normal = other;
    }
    const glm::dvec3 origin(positions_[triangles_[a][0]]);
    const double length = glm::length(normal);
    return std::all_of(triangles_[b].begin(), triangles_[b].end(), [&](std::uint32_t corner) {
        const glm::dvec3 at(positions_[corner]);
        return std::abs(glm::dot(at - origin, normal)) <=
               Roundings * length * std::max(glm::length(at), glm::length(origin));
    });
}

} // namespace relumine::prt
