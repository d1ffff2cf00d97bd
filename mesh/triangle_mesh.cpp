#include "mesh/triangle_mesh.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace relumine::mesh {

float Bounds::diagonal() const {
    return static_cast<float>(glm::length(glm::dvec3(max) - glm::dvec3(min)));
}

Bounds bounds(const TriangleMesh& mesh) {
    if (mesh.positions.empty())
        return {};
    const glm::vec3 first = mesh.positions[mesh.triangles.empty() ? 0 : mesh.triangles.front()[0]];
    Bounds box{first, first};
    const auto extend = [&box](const glm::vec3& point) {
        box.min = glm::min(box.min, point);
        box.max = glm::max(box.max, point);
    };
    for (const Triangle& triangle : mesh.triangles)
        for (const std::uint32_t vertex : triangle)
            extend(mesh.positions[vertex]);
    if (mesh.triangles.empty())
        for (const glm::vec3& point : mesh.positions)
            extend(point);
    return box;
}

} // namespace relumine::mesh
