#include "mesh/opacity.h"

#include <algorithm>
#include <array>

namespace relumine::mesh {

glm::vec2 uv_at(const TriangleMesh& mesh, std::uint32_t triangle, const glm::vec2& barycentric) {
    const auto between = [&](const std::array<glm::vec2, 3>& corners) {
        return corners[0] * (1.0f - barycentric.x - barycentric.y) + corners[1] * barycentric.x +
               corners[2] * barycentric.y;
    };
    const Triangle& t = mesh.triangles[triangle];
    if (!mesh.corner_uvs.empty())
        return between(mesh.corner_uvs[triangle]);
    if (!mesh.uvs.empty())
        return between({mesh.uvs[t[0]], mesh.uvs[t[1]], mesh.uvs[t[2]]});
    return glm::vec2(0.0f);
}

bool lets_light_pass(const Material& material) {
    const float opaque = material.alpha_mode == AlphaMode::Mask ? material.alpha_cutoff : 1.0f;
    return material.alpha_mode != AlphaMode::Opaque &&
           (material.alpha_texture || material.alpha < opaque);
}

bool lets_light_pass(const TriangleMesh& mesh) {
    return !mesh.triangle_materials.empty() &&
           std::any_of(mesh.materials.begin(), mesh.materials.end(),
                       [](const Material& material) { return lets_light_pass(material); });
}

bool lets_eye_pass(const Material& material) {
    return !material.is_double_sided || lets_light_pass(material);
}

float opacity(const TriangleMesh& mesh, std::uint32_t triangle, const glm::vec2& barycentric) {
    const Material& material = mesh.materials[mesh.triangle_materials[triangle]];
    if (material.alpha_mode == AlphaMode::Opaque)
        return 1.0f;
    float alpha = material.alpha;
    if (const auto& slot = material.alpha_texture)
        alpha *= sample(mesh.textures[slot->texture], *slot, uv_at(mesh, triangle, barycentric)).r;
    if (material.alpha_mode == AlphaMode::Mask)
        return alpha < material.alpha_cutoff ? 0.0f : 1.0f;
    return alpha;
}

Material without_colors(const Material& material) {
    return {.name = "option",
            .alpha_mode = material.alpha_mode,
            .alpha = material.alpha,
            .alpha_cutoff = material.alpha_cutoff,
            .alpha_texture = material.alpha_texture,
            .is_double_sided = material.is_double_sided};
}

TriangleMesh blockers_of(const TriangleMesh& mesh) {
    TriangleMesh blockers;
    blockers.positions = mesh.positions;
    blockers.triangles = mesh.triangles;
    if (!lets_light_pass(mesh))
        return blockers;
    blockers.uvs = mesh.uvs;
    blockers.corner_uvs = mesh.corner_uvs;
    blockers.triangle_materials = mesh.triangle_materials;
    blockers.textures.resize(mesh.textures.size());
    for (const Material& material : mesh.materials) {
        blockers.materials.push_back(without_colors(material));
        if (const auto& slot = material.alpha_texture)
            blockers.textures[slot->texture] = mesh.textures[slot->texture];
    }
    return blockers;
}

} // namespace relumine::mesh
