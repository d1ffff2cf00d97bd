#include "relumine/light/passed_on.h"

#include <array>
#include <cstdint>

#include "prt/glossy/surface_sampling.h"
#include "prt/visibility/twin_triangles.h"

namespace relumine {

std::vector<relight::PassedOn> passed_on(const Scene& scene) {
    std::vector<relight::PassedOn> result;
    const mesh::TriangleMesh& mesh = scene.mesh;
    if (!prt::on_vertices(scene.layout) || scene.settings.glossy_tolerance ||
        scene.receivers.surfaces.size() != mesh.num_vertices() || !prt::passes_light_on(mesh))
        return result;
    const prt::TwinTriangles twins(mesh);
    std::vector<bool> is_known(mesh.num_vertices());
    constexpr std::array<glm::vec2, 3> Corners = {glm::vec2(0.0f, 0.0f), glm::vec2(1.0f, 0.0f),
                                                  glm::vec2(0.0f, 1.0f)};
    for (std::uint32_t triangle = 0; triangle < mesh.num_triangles(); ++triangle)
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint32_t vertex = mesh.triangles[triangle][corner];
            if (is_known[vertex] || !prt::passes_light_on(mesh, triangle))
                continue;
            const prt::MeshPoint at{triangle, Corners[corner]};
            const auto behind = twins.other_side({at.triangle, at.barycentric});
            if (!behind)
                continue;
            is_known[vertex] = true;
            result.push_back(
                {.receiver = vertex,
                 .other = prt::vertex_at(mesh, {behind->triangle, behind->barycentric}),
                 .part = prt::passed_on_at(mesh, at)});
        }
    return result;
}

} // namespace relumine
