#include "mesh/triangle_mesh.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace relumine::mesh {

float Bounds::diagonal() const {
    return static_cast<float>(glm::length(glm::dvec3(max) - glm::dvec3(min)));
}

Bounds bounds(const TriangleMesh& mesh) {
    if (mesh.triangles.empty())
        return bounds(mesh.positions);
    const glm::vec3 first = mesh.positions[mesh.triangles.front()[0]];
    Bounds box{first, first};
    for (const Triangle& triangle : mesh.triangles)
        for (const std::uint32_t vertex : triangle) {
            box.min = glm::min(box.min, mesh.positions[vertex]);
            box.max = glm::max(box.max, mesh.positions[vertex]);
        }
    return box;
}

Bounds bounds(std::span<const glm::vec3> points) {
    if (points.empty())
        return {};
    Bounds box{points.front(), points.front()};
    for (const glm::vec3& point : points) {
        box.min = glm::min(box.min, point);
        box.max = glm::max(box.max, point);
    }
    return box;
}

std::vector<std::string> left_out(const TriangleMesh& mesh) {
    std::vector<std::string> lines = mesh.warnings;
    for (const std::string& name : mesh.missing)
        lines.push_back("no " + name + " is found");
    return lines;
}

} // namespace relumine::mesh
