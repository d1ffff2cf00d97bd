#include "mesh/normals.h"

#include <cmath>

#include <glm/geometric.hpp>

namespace relumine::mesh {

std::vector<glm::vec3> smooth_normals(const TriangleMesh& mesh) {
    std::vector<glm::dvec3> sums(mesh.num_vertices(), glm::dvec3(0.0));
    for (const Triangle& triangle : mesh.triangles) {
        const std::array<glm::dvec3, 3> corners = {glm::dvec3(mesh.positions[triangle[0]]),
                                                   glm::dvec3(mesh.positions[triangle[1]]),
                                                   glm::dvec3(mesh.positions[triangle[2]])};
        const glm::dvec3 area_normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
        const double twice_area = glm::length(area_normal);
        if (twice_area == 0.0)
            continue;
        for (std::size_t i = 0; i < 3; ++i) {
            // |a x b| is twice the area at every corner, so the angle needs one dot product. atan2
            // is exact near 0 and pi.
            const double angle =
                std::atan2(twice_area, glm::dot(corners[(i + 1) % 3] - corners[i],
                                                corners[(i + 2) % 3] - corners[i]));
            sums[triangle[i]] += area_normal * (angle / twice_area);
        }
    }
    std::vector<glm::vec3> normals(mesh.num_vertices(), glm::vec3(0.0f));
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const double length = glm::length(sums[i]);
        if (length > 0.0)
            normals[i] = glm::vec3(sums[i] / length);
    }
    return normals;
}

} // namespace relumine::mesh
