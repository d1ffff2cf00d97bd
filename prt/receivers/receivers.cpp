#include "prt/receivers/receivers.h"

#include <algorithm>
#include <stdexcept>

#include <glm/geometric.hpp>

namespace relumine::prt {

Receivers vertex_receivers(const mesh::TriangleMesh& mesh) {
    return {.positions = mesh.positions, .normals = mesh.normals};
}

std::vector<glm::vec3> colors_at(const mesh::TriangleMesh& mesh, const Receivers& receivers) {
    if (mesh.colors.empty())
        throw std::invalid_argument("expected a mesh with vertex colours, got one without");
    if (receivers.points.empty())
        return mesh.colors;
    std::vector<glm::vec3> colors(receivers.size());
    std::transform(receivers.points.begin(), receivers.points.end(), colors.begin(),
                   [&](const MeshPoint& point) { return value_at(mesh, mesh.colors, point); });
    return colors;
}

void look_from(Receivers& receivers, const glm::vec3& eye) {
    receivers.to_eye.clear();
    for (const glm::vec3& position : receivers.positions) {
        const glm::vec3 to_eye = eye - position;
        const float distance = glm::length(to_eye);
        receivers.to_eye.push_back(distance > 0.0f ? to_eye / distance
                                                   : glm::vec3(0.0f, 1.0f, 0.0f));
    }
}

} // namespace relumine::prt
