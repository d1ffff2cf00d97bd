#include "mesh/opacity.h"

#include <algorithm>
#include <optional>

#include <glm/exponential.hpp>

#include "mesh/tangents.h"

namespace relumine::mesh {

glm::vec2 uv_at(const TriangleMesh& mesh, std::uint32_t triangle, const glm::vec2& barycentric,
                std::uint32_t uv_set) {
    const auto corner = [&](std::size_t k) {
        return corner_uv(mesh, triangle, k, uv_set);
    };
    return corner(0) * (1.0f - barycentric.x - barycentric.y) + corner(1) * barycentric.x +
           corner(2) * barycentric.y;
}

bool lets_light_pass(const Material& material) {
    const float opaque = material.alpha_mode == AlphaMode::Mask ? material.alpha_cutoff : 1.0f;
    return material.transmission > 0.0f || (material.alpha_mode != AlphaMode::Opaque &&
                                            (material.alpha_texture || material.alpha < opaque));
}

bool lets_light_pass(const TriangleMesh& mesh) {
    return !mesh.triangle_materials.empty() &&
           std::any_of(mesh.materials.begin(), mesh.materials.end(),
                       [](const Material& material) { return lets_light_pass(material); });
}

bool is_thin(const Material& material) {
    return lets_light_pass(material) &&
           (material.transmission > 0.0f || material.alpha_mode == AlphaMode::Blend);
}

bool lets_eye_pass(const Material& material) {
    return !material.is_double_sided || lets_light_pass(material);
}

namespace {

/// Returns the parts by which a surface of glass multiplies what goes on through it. `textured`
/// multiplies a value with its texture.
template<typename Textured>
glm::vec3 glass_tint(const Material& material, const Textured& textured) {
    const float metallic =
        textured(glm::vec3(material.metallic), material.metallic_roughness_texture).b;
    const float part = textured(glm::vec3(material.transmission), material.transmission_texture).r *
                       (1.0f - metallic);
    const glm::vec3 tint = textured(material.base_color, material.base_color_texture);
    return part * (material.thickness == 0.0f ? tint : glm::sqrt(tint));
}

/// What goes on through a surface of glass.
template<typename Textured>
glm::vec3 through_glass(const Material& material, const Textured& textured) {
    constexpr float Reflected = 0.04f;
    const glm::vec3 through = (1.0f - Reflected) * glass_tint(material, textured);
    if (material.thickness == 0.0f)
        return through;
    const float way = 0.5f * material.thickness / material.attenuation_distance;
    return through * glm::pow(material.attenuation_color, glm::vec3(way));
}

/// Looks the textures of a triangle's material up at a point.
auto textured_at(const TriangleMesh& mesh, std::uint32_t triangle, const glm::vec2& barycentric) {
    return [&mesh, triangle, barycentric](const glm::vec3& value,
                                          const std::optional<TextureSlot>& slot) {
        return slot ? value * sample(mesh.textures[slot->texture], *slot,
                                     uv_at(mesh, triangle, barycentric, slot->uv_set))
                    : value;
    };
}

template<typename Textured>
Veil veil_of(const Material& material, const Textured& textured) {
    if (!lets_light_pass(material))
        return {};
    Veil veil;
    if (material.alpha_mode != AlphaMode::Opaque) {
        veil.weight = textured(glm::vec3(material.alpha), material.alpha_texture).r;
        if (material.alpha_mode == AlphaMode::Mask)
            veil.weight = veil.weight < material.alpha_cutoff ? 0.0f : 1.0f;
        veil.through = glm::vec3(1.0f - veil.weight);
    }
    if (material.transmission > 0.0f)
        veil.through += veil.weight * through_glass(material, textured);
    return veil;
}

} // namespace

Veil veil(const TriangleMesh& mesh, std::uint32_t triangle, const glm::vec2& barycentric) {
    return veil_of(mesh.materials[mesh.triangle_materials[triangle]],
                   textured_at(mesh, triangle, barycentric));
}

glm::vec3 glass_tint(const TriangleMesh& mesh, std::uint32_t triangle,
                     const glm::vec2& barycentric) {
    return glass_tint(mesh.materials[mesh.triangle_materials[triangle]],
                      textured_at(mesh, triangle, barycentric));
}

Veil veil(const Material& material, std::span<const Texture> textures, const glm::vec2& place) {
    return veil_of(material, [&](const glm::vec3& value, const std::optional<TextureSlot>& slot) {
        if (!slot)
            return value;
        TextureSlot own = *slot;
        own.uv_from_mesh_uv = glm::mat2(1.0f);
        own.uv_offset = glm::vec2(0.0f);
        return value * sample(textures[slot->texture], own, place);
    });
}

Material passed_as(Material material, const Material& other) {
    material.alpha_mode = other.alpha_mode;
    material.alpha = other.alpha;
    material.alpha_cutoff = other.alpha_cutoff;
    material.alpha_texture = other.alpha_texture;
    material.transmission = other.transmission;
    material.transmission_texture = other.transmission_texture;
    material.thickness = other.thickness;
    material.attenuation_color = other.attenuation_color;
    material.attenuation_distance = other.attenuation_distance;
    material.dispersion = other.dispersion;
    material.is_double_sided = other.is_double_sided;
    return material;
}

Material without_colors(const Material& material) {
    return passed_as({.name = "option"}, material);
}

TriangleMesh blockers_of(const TriangleMesh& mesh) {
    TriangleMesh blockers;
    blockers.positions = mesh.positions;
    blockers.triangles = mesh.triangles;
    blockers.groups = mesh.groups;
    blockers.triangle_groups = mesh.triangle_groups;
    if (!lets_light_pass(mesh))
        return blockers;
    blockers.uvs = mesh.uvs;
    blockers.second_uvs = mesh.second_uvs;
    blockers.corner_uvs = mesh.corner_uvs;
    blockers.triangle_materials = mesh.triangle_materials;
    blockers.textures.resize(mesh.textures.size());
    for (const Material& material : mesh.materials) {
        Material& kept = blockers.materials.emplace_back(without_colors(material));
        if (material.transmission > 0.0f) {
            kept.metallic = material.metallic;
            kept.metallic_roughness_texture = material.metallic_roughness_texture;
            kept.base_color = material.base_color;
            kept.base_color_texture = material.base_color_texture;
        }
        for (const auto& slot : {kept.alpha_texture, kept.base_color_texture,
                                 kept.metallic_roughness_texture, kept.transmission_texture})
            if (slot && blockers.textures[slot->texture].texels.empty())
                blockers.textures[slot->texture] = mesh.textures[slot->texture];
    }
    return blockers;
}

} // namespace relumine::mesh
