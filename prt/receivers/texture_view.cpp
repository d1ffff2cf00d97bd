#include "prt/receivers/texture_view.h"

#include <algorithm>

#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>

#include "mesh/tangents.h"

namespace relumine::prt {

glm::dmat2 TextureView::steps(const mesh::TriangleMesh& mesh, const MeshPoint& point) const {
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
        return glm::dmat2(0.0);
    const auto step = [&](const glm::vec3& turn) {
        // From the plane of the picture along the rays onto that of the triangle.
        const glm::dvec3 aside = depth * glm::dvec3(turn);
        const glm::dvec3 move = aside - glm::dot(normal, aside) / slope * to_point;
        return glm::dvec2(glm::dot(glm::cross(move, v), normal) / square,
                          glm::dot(glm::cross(u, move), normal) / square);
    };
    return {step(right), step(down)};
}

mesh::Footprint TextureView::footprint(const mesh::TriangleMesh& mesh, const MeshPoint& point,
                                       std::uint32_t uv_set) const {
    const glm::vec2 uv0 = mesh::corner_uv(mesh, point.triangle, 0, uv_set);
    const glm::dvec2 of_u(mesh::corner_uv(mesh, point.triangle, 1, uv_set) - uv0);
    const glm::dvec2 of_v(mesh::corner_uv(mesh, point.triangle, 2, uv_set) - uv0);
    const glm::dmat2 moves = glm::dmat2(of_u, of_v) * steps(mesh, point);
    return {.right = glm::vec2(moves[0]), .down = glm::vec2(moves[1])};
}

float TextureView::normal_spread(const mesh::TriangleMesh& mesh, const MeshPoint& point) const {
    const mesh::Triangle& triangle = mesh.triangles[point.triangle];
    const glm::dvec3 origin(mesh.normals[triangle[0]]);
    const glm::dvec3 u = glm::dvec3(mesh.normals[triangle[1]]) - origin;
    const glm::dvec3 v = glm::dvec3(mesh.normals[triangle[2]]) - origin;
    if (u == glm::dvec3(0.0) && v == glm::dvec3(0.0))
        return 0.0f;
    const glm::dmat2 moves = steps(mesh, point);
    // Samples whose normals differ by less share their rays.
    constexpr double Shared = 0.02;
    double sum = 0.0;
    for (int axis = 0; axis < 2; ++axis) {
        const double turn = glm::length(moves[axis].x * u + moves[axis].y * v);
        const double all = std::max(turn, std::min(samples_per_axis * turn, Shared));
        sum += all * all / 12.0;
    }
    return static_cast<float>(std::min(sum, 1.0));
}

} // namespace relumine::prt
