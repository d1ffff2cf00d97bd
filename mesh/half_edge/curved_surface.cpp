#include "mesh/half_edge/curved_surface.h"

#include <glm/geometric.hpp>

#include "mesh/edge_uses.h"

namespace relumine::mesh {

CurvedSurface::CurvedSurface(const TriangleMesh& mesh)
    : mesh_(mesh), straight_(mesh.num_triangles(), 7) {
    for_each_edge(edge_uses(mesh.triangles), [&](std::span<const EdgeUse> edge) {
        if (is_smooth_join(edge))
            for (const EdgeUse& use : edge)
                straight_[use.triangle()] &= static_cast<std::uint8_t>(~(1u << use.corner % 3));
    });
}

glm::vec3 CurvedSurface::at(std::uint32_t triangle, const glm::vec2& weights) const {
    const Triangle& corners = mesh_.triangles[triangle];
    std::array<glm::dvec3, 3> p{}, n{};
    for (std::size_t i = 0; i < 3; ++i) {
        p[i] = mesh_.positions[corners[i]];
        n[i] = mesh_.normals[corners[i]];
    }
    // The point of side i that lies at a third from its first or its second corner.
    const auto near = [&](std::size_t i, bool is_first) {
        const std::size_t j = (i + 1) % 3;
        const std::size_t from = is_first ? i : j, to = is_first ? j : i;
        const glm::dvec3 third = (2.0 * p[from] + p[to]) / 3.0;
        if ((straight_[triangle] >> i & 1u) != 0)
            return third;
        return third - glm::dot(p[to] - p[from], n[from]) / 3.0 * n[from];
    };
    const std::array<double, 3> w = {1.0 - double{weights.x} - double{weights.y}, weights.x,
                                     weights.y};
    glm::dvec3 sides(0.0), result(0.0);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const glm::dvec3 first = near(i, true), second = near(i, false);
        sides += first + second;
        result += w[i] * w[i] * w[i] * p[i];
        result += 3.0 * w[i] * w[j] * (w[i] * first + w[j] * second);
    }
    const glm::dvec3 middle = sides / 4.0 - (p[0] + p[1] + p[2]) / 6.0;
    return glm::vec3(result + 6.0 * w[0] * w[1] * w[2] * middle);
}

} // namespace relumine::mesh
