#include "prt/receivers/lit_position.h"

#include <cstddef>

#include <glm/geometric.hpp>

#include "files/parallel.h"

namespace relumine::prt {

namespace {

glm::vec3 before_obstacles(const RayScene& rays, const glm::vec3& own, const glm::vec3& smooth,
                           const glm::vec3& normal, float bias) {
    // As much room must be left beyond the smooth surface, or the next thing nearly touches it.
    constexpr float Room = 2.0f;
    const glm::vec3 origin = ray_origin(own, normal, bias);
    const glm::vec3 way = ray_origin(smooth, normal, bias) - origin;
    // What is closer than the bias is no obstacle to a point without a way, either.
    const bool leads_away = glm::dot(way, way) > bias * bias;
    return leads_away && rays.occluded(origin, way, Room) ? own : smooth;
}

} // namespace

glm::vec3 lit_position(const mesh::TriangleMesh& mesh, const RayScene& rays, const MeshPoint& at,
                       const glm::vec3& normal, float bias) {
    return before_obstacles(rays, value_at(mesh, mesh.positions, at), smooth_position(mesh, at),
                            normal, bias);
}

void leave_obstacles(const mesh::TriangleMesh& mesh, const RayScene& rays, float bias,
                     Receivers& receivers) {
    files::parallel_for(std::size_t{0}, receivers.points.size(), [&](std::size_t i) {
        receivers.positions[i] =
            before_obstacles(rays, value_at(mesh, mesh.positions, receivers.points[i]),
                             receivers.positions[i], receivers.normals[i], bias);
    });
}

} // namespace relumine::prt
