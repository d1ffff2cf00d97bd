#include "mesh/customs.h"

#include <algorithm>
#include <iterator>

#include <glm/geometric.hpp>

#include "mesh/formats/mesh_format.h"

namespace relumine::mesh {

UpAxis customary_up(const std::filesystem::path& path) {
    const MeshFormat* format = format_of(path);
    return format != nullptr ? format->up : UpAxis::Y;
}

std::optional<float> customary_crease(const std::filesystem::path& path) {
    const MeshFormat* format = format_of(path);
    return format != nullptr ? format->crease : std::nullopt;
}

bool stands_on_z(const TriangleMesh& mesh, std::size_t num_vertices) {
    TriangleMesh own;
    own.positions = mesh.positions;
    std::copy_if(mesh.triangles.begin(), mesh.triangles.end(), std::back_inserter(own.triangles),
                 [&](const Triangle& triangle) { return triangle[0] < num_vertices; });
    const Bounds box = bounds(own);
    const glm::vec3 size = box.size();
    // The part of the box's side towards - `axis` that faces lie on and look out of.
    const auto covered = [&](int axis) {
        double area = 0.0;
        for (const auto& [a, b, c] : own.triangles) {
            const float highest =
                std::max({own.positions[a][axis], own.positions[b][axis], own.positions[c][axis]});
            if (highest - box.min[axis] < 1e-3f * size[axis])
                area -= 0.5 * glm::cross(own.positions[b] - own.positions[a],
                                         own.positions[c] - own.positions[a])[axis];
        }
        return area / (double{size[(axis + 1) % 3]} * size[(axis + 2) % 3]);
    };
    const bool is_flat = std::min({size.x, size.y, size.z}) < 0.05f * box.diagonal();
    return !is_flat && covered(2) > 0.3 && covered(1) < 0.02;
}

} // namespace relumine::mesh
