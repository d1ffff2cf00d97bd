#include "relumine/in/material_report.h"

#include <optional>

namespace relumine {

namespace {

using files::Json;

/// What metallic-roughness materials have beside their base, where it changes something.
void add_layers(const mesh::TriangleMesh& mesh, const mesh::Material& material, Json& result) {
    const mesh::Material usual;
    const auto add_texture = [&](const char* name, const std::optional<mesh::TextureSlot>& slot) {
        if (slot)
            result.set(name, mesh.textures[slot->texture].name);
    };
    result.set("metallic", material.metallic);
    if (material.ior != usual.ior)
        result.set("ior", material.ior);
    if (material.specular_strength != usual.specular_strength)
        result.set("specular_strength", material.specular_strength);
    if (material.specular_tint != usual.specular_tint)
        result.set("specular_tint", material.specular_tint);
    add_texture("specular_strength_texture", material.specular_strength_texture);
    add_texture("specular_tint_texture", material.specular_tint_texture);
    if (material.coat != usual.coat) {
        result.set("coat", material.coat);
        result.set("coat_roughness", material.coat_roughness);
        add_texture("coat_texture", material.coat_texture);
        add_texture("coat_roughness_texture", material.coat_roughness_texture);
        add_texture("coat_normal_texture", material.coat_normal_texture);
    }
    if (material.sheen != usual.sheen) {
        result.set("sheen", material.sheen);
        result.set("sheen_roughness", material.sheen_roughness);
        add_texture("sheen_texture", material.sheen_texture);
        add_texture("sheen_roughness_texture", material.sheen_roughness_texture);
    }
}

} // namespace

Json report_of(const mesh::TriangleMesh& mesh, const mesh::Material& material) {
    const auto texture = [&mesh](const std::optional<mesh::TextureSlot>& slot) {
        return slot ? Json(mesh.textures[slot->texture].name) : Json(nullptr);
    };
    using Model = mesh::MaterialModel;
    const Model model = material.model;
    Json result = {{"name", material.name},
                   {"model", model == Model::Phong               ? "phong"
                             : model == Model::MetallicRoughness ? "metallic-roughness"
                             : model == Model::Unlit             ? "unlit"
                             : model == Model::Measured          ? "measured"
                                                                 : "specular-glossiness"},
                   {"base_color", material.base_color},
                   {"base_color_texture", texture(material.base_color_texture)}};
    if (material.emission != glm::vec3(0.0f)) {
        result.set("emission", material.emission);
        result.set("emission_texture", texture(material.emission_texture));
    }
    if (model == Model::Unlit)
        return result;
    if (model != Model::MetallicRoughness)
        result.set("specular", material.specular);
    if (model == Model::Phong) {
        result.set("exponent", material.exponent);
        if (material.specular_texture)
            result.set("specular_texture", texture(material.specular_texture));
    } else {
        result.set("roughness", material.roughness);
        result.set("metallic_roughness_texture", texture(material.metallic_roughness_texture));
        if (material.roughness_texture)
            result.set("roughness_texture", texture(material.roughness_texture));
        if (material.metallic_texture)
            result.set("metallic_texture", texture(material.metallic_texture));
    }
    if (material.normal_texture) {
        result.set("normal_texture", texture(material.normal_texture));
        result.set("normal_scale", material.normal_scale);
    }
    if (model == Model::MetallicRoughness)
        add_layers(mesh, material, result);
    else if (model == Model::SpecularGlossiness)
        result.set("specular_texture", texture(material.specular_texture));
    return result;
}

} // namespace relumine
