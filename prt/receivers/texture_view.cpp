#include "prt/receivers/texture_view.h"

#include <glm/geometric.hpp>

#include "mesh/tangents.h"

namespace relumine::prt {

mesh::Footprint TextureView::footprint(const mesh::TriangleMesh& mesh, const MeshPoint& point,
                                       std::uint32_t uv_set) const {
    const mesh::Triangle& triangle = mesh.triangles[point.triangle];
    const glm::dvec3 origin(mesh.positions[triangle[0]]);
    const glm::dvec3 u = glm::dvec3(mesh.positions[triangle[1]]) - origin;
    const glm::dvec3 v = glm::dvec3(mesh.positions[triangle[2]]) - origin;
    const glm::dvec3 normal = glm::cross(u, v);
    const double square = glm::dot(normal, normal);
    const glm::dvec3 to_point = glm::dvec3(value_at(mesh, mesh.positions, point) - eye);
    const double depth = glm::dot(to_point, glm::dvec3(forward));
    const double slope = glm::dot(to_point, normal);
    if (!(depth > 0.0) || slope == 0.0 || !(square > 0.0))
        return {};
    const glm::vec2 uv0 = mesh::corner_uv(mesh, point.triangle, 0, uv_set);
    const glm::dvec2 of_u(mesh::corner_uv(mesh, point.triangle, 1, uv_set) - uv0);
    const glm::dvec2 of_v(mesh::corner_uv(mesh, point.triangle, 2, uv_set) - uv0);
    const auto step = [&](const glm::vec3& turn) {
        // From the plane of the picture along the rays onto that of the triangle.
        const glm::dvec3 aside = depth * glm::dvec3(turn);
        const glm::dvec3 move = aside - glm::dot(normal, aside) / slope * to_point;
        return glm::vec2(glm::dot(glm::cross(move, v), normal) / square * of_u +
                         glm::dot(glm::cross(u, move), normal) / square * of_v);
    };
    return {.right = step(right), .down = step(down)};
}

} // namespace relumine::prt
