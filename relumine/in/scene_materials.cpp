#include "relumine/in/scene_materials.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include <glm/common.hpp>

#include "mesh/opacity.h"
#include "prt/glossy/surface_sampling.h"

namespace relumine {

namespace {

/// Gives triangles of other surfaces than the file's a material of their own: plain, or with their
/// highlight where there is no eye.
void replace_materials(mesh::TriangleMesh& mesh, const prt::SurfaceOverride& surface_of,
                       bool has_eye) {
    const bool has_materials = !mesh.triangle_materials.empty();
    const auto first = static_cast<std::ptrdiff_t>(mesh.materials.size());
    const auto material_of = [&](std::uint32_t triangle, const prt::Surface& surface) {
        const bool is_plain = has_eye || surface.highlight == prt::Highlight::None;
        mesh::Material kept = prt::material_of(is_plain ? prt::Surface() : surface);
        if (has_materials) // rays pass it as before
            kept = mesh::passed_as(kept, mesh.materials[mesh.triangle_materials[triangle]]);
        const auto found = std::find(mesh.materials.begin() + first, mesh.materials.end(), kept);
        const auto index = static_cast<std::uint32_t>(found - mesh.materials.begin());
        if (found == mesh.materials.end())
            mesh.materials.push_back(kept);
        return index;
    };
    std::vector<std::uint32_t> result = mesh.triangle_materials;
    result.resize(mesh.num_triangles());
    for (std::uint32_t i = 0; i < mesh.num_triangles(); ++i) {
        const prt::Surface own = prt::surface_at(mesh, i, glm::vec2(1.0f / 3.0f));
        const prt::Surface surface = surface_of(mesh, i, own);
        if (surface != own || !has_materials)
            result[i] = material_of(i, surface);
    }
    mesh.triangle_materials = std::move(result);
}

} // namespace

void keep_materials(mesh::TriangleMesh& mesh, prt::Receivers& receivers,
                    const prt::SurfaceOverride& surface_of, bool are_replaced) {
    const bool has_eye = !receivers.to_eye.empty(), are_points = !receivers.points.empty();
    const bool has_textures = !mesh.textures.empty() && !mesh.triangle_materials.empty();
    const bool mirrors =
        !has_eye &&
        std::any_of(receivers.surfaces.begin(), receivers.surfaces.end(),
                    [](const prt::Surface& own) { return own.highlight != prt::Highlight::None; });
    if (!has_textures && !mirrors && !are_points && !prt::passes_light_on(mesh))
        return;
    if (are_replaced)
        replace_materials(mesh, surface_of, has_eye);
    constexpr float LeastAlbedo = 1.0f / 255.0f / 12.92f;
    for (std::size_t i = are_points ? receivers.num_own() : 0; i < receivers.size(); ++i)
        if (prt::Surface& surface = receivers.surfaces[i];
            surface.highlight != prt::Highlight::None || surface.emission == glm::vec3(0.0f))
            surface.albedo = glm::max(surface.albedo, LeastAlbedo); // not of unlit ones
}

} // namespace relumine
