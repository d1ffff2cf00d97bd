// The list of what a material has beside its name and its table.
#pragma once

#include <array>
#include <limits>
#include <string_view>
#include <variant>

#include "mesh/materials/material.h"

namespace relumine::mesh {

/// When a member stands in a scene file or a report: always, with some models, where it is not the
/// usual value, or where another one is not.
struct MemberRule {
    /// Bit i: always, where the model is number i.
    unsigned models = 0;
    /// With other models: where it is not the usual value.
    bool if_unusual = true;
    std::string_view with = {};
};

/// A member of a material. Scene files, reports and what goes over all textures read this list.
struct MaterialMember {
    using Texture = std::optional<TextureSlot>;
    using Place = std::variant<MaterialModel Material::*, AlphaMode Material::*, bool Material::*,
                               float Material::*, glm::vec3 Material::*, Texture Material::*>;

    std::string_view name;
    Place at;
    MemberRule in_report = {};
    MemberRule in_file = {};
    /// The name in scene files, if it is another one.
    std::string_view other_name = {};
    /// What numbers and colours of scene files may be.
    float least = 0.0f;
    float most = 1.0f;
    /// Scene files have it only for highlights that pictures find by rays.
    bool is_of_highlight = false;

    [[nodiscard]] std::string_view name_in_file() const {
        return other_name.empty() ? name : other_name;
    }
    /// Null for a member that is no texture.
    [[nodiscard]] Texture Material::* texture() const {
        const auto* const slot = std::get_if<Texture Material::*>(&at);
        return slot != nullptr ? *slot : nullptr;
    }
    [[nodiscard]] bool is_usual(const Material& material) const;
    [[nodiscard]] bool stands(const Material& material, const MemberRule& rule) const;
};

/// Members stand behind those that they go with. Of textures, the colours come first: where a mesh
/// has too few uvs, the last ones are left out.
inline constexpr auto MaterialMembers = [] {
    using M = Material;
    using Member = MaterialMember;
    constexpr float Any = std::numeric_limits<float>::max();
    constexpr MemberRule Always{.models = ~0u}, Never{.if_unusual = false};
    constexpr auto of = [](auto... models) {
        return ((1u << static_cast<unsigned>(models)) | ...);
    };
    using enum MaterialModel;
    constexpr unsigned Rough = of(MetallicRoughness, SpecularGlossiness, Measured);
    constexpr MemberRule OfMetal{of(MetallicRoughness)}, OfRough{Rough},
        OfGloss{of(SpecularGlossiness)}, OfPhong{of(Phong), false},
        NotOfMetal{of(Phong, SpecularGlossiness, Measured), false};
    constexpr MemberRule Glows{.with = "emission"}, Coated{.with = "coat"}, Cloth{.with = "sheen"},
        Filmed{.with = "film"}, Stretched{.with = "anisotropy"}, Glass{.with = "transmission"},
        LetsThrough{.with = "diffuse_transmission"}, Passed{.with = "alpha_mode"},
        Normals{.with = "normal_texture"}, CoatNormals{.with = "coat_normal_texture"};
    return std::array{
        Member{"model", &M::model, Never, Always, {}, 0.0f, 4.0f},
        Member{"base_color", &M::base_color, Always, Always, "base"},
        Member{"times_vertex_color", &M::times_vertex_color, Never, Always},
        Member{"base_color_texture", &M::base_color_texture, Always, Always, "base_texture"},
        Member{"metallic", &M::metallic, OfMetal, Always},
        Member{"roughness", &M::roughness, OfRough, Never, {}, 0.0f, 1.0f, true},
        Member{"metallic_roughness_texture", &M::metallic_roughness_texture, OfRough, OfMetal,
               "metallic_texture"},
        Member{"specular", &M::specular, NotOfMetal, Always},
        Member{"exponent", &M::exponent, OfPhong, Never, {}, 0.0f, Any, true},
        Member{"specular_texture", &M::specular_texture, OfGloss, OfGloss},
        Member{"roughness_texture", &M::roughness_texture, {}, {}, "own_roughness_texture"},
        Member{"metallic_texture", &M::metallic_texture, {}, {}, "own_metallic_texture"},
        Member{"emission", &M::emission, {}, {}, {}, 0.0f, Any},
        Member{"emission_texture", &M::emission_texture, Glows, Glows},
        Member{"transmission", &M::transmission, Never},
        Member{"transmission_texture", &M::transmission_texture, Never, Glass},
        Member{"thickness", &M::thickness, Never, Glass, {}, 0.0f, Any},
        Member{"attenuation", &M::attenuation_color, Never, Glass},
        Member{"dispersion", &M::dispersion, {}, {}, {}, 0.0f, Any},
        Member{"diffuse_transmission", &M::diffuse_transmission},
        Member{"diffuse_transmission_texture", &M::diffuse_transmission_texture, {}, LetsThrough},
        Member{"diffuse_transmission_color", &M::diffuse_transmission_color, LetsThrough,
               LetsThrough},
        Member{"diffuse_transmission_color_texture",
               &M::diffuse_transmission_color_texture,
               {},
               LetsThrough},
        Member{"normal_texture", &M::normal_texture},
        Member{"normal_scale", &M::normal_scale, Normals, Normals, {}, -Any, Any},
        Member{"ior", &M::ior, {}, {}, {}, 0.0f, 1e6f},
        Member{"specular_strength", &M::specular_strength, {}, {}, {}, 0.0f, 1e6f},
        Member{"specular_strength_texture", &M::specular_strength_texture},
        Member{"specular_tint", &M::specular_tint, {}, {}, {}, 0.0f, 1e6f},
        Member{"specular_tint_texture", &M::specular_tint_texture},
        Member{"coat", &M::coat},
        Member{"coat_texture", &M::coat_texture},
        Member{"coat_roughness", &M::coat_roughness, Coated},
        Member{"coat_roughness_texture", &M::coat_roughness_texture},
        Member{"coat_normal_texture", &M::coat_normal_texture},
        Member{"coat_normal_scale", &M::coat_normal_scale, Never, CoatNormals, {}, -Any, Any},
        Member{"sheen", &M::sheen},
        Member{"sheen_texture", &M::sheen_texture},
        Member{"sheen_roughness", &M::sheen_roughness, Cloth},
        Member{"sheen_roughness_texture", &M::sheen_roughness_texture},
        Member{"film", &M::film},
        Member{"film_texture", &M::film_texture},
        Member{"film_ior", &M::film_ior, Filmed, Filmed, {}, 1.0f, 1e6f},
        Member{"film_thickness_at_0", &M::film_thickness_at_0, Filmed, Filmed, {}, 0.0f, Any},
        Member{"film_thickness_at_1", &M::film_thickness_at_1, Filmed, Filmed, {}, 0.0f, Any},
        Member{"film_thickness_texture", &M::film_thickness_texture},
        Member{"anisotropy", &M::anisotropy},
        Member{"anisotropy_rotation", &M::anisotropy_rotation, Stretched, Stretched, {}, -Any, Any},
        Member{"anisotropy_texture", &M::anisotropy_texture},
        Member{"alpha_mode", &M::alpha_mode, Never, {}, {}, 0.0f, 2.0f},
        Member{"alpha", &M::alpha, Never, Passed},
        Member{"alpha_cutoff", &M::alpha_cutoff, Never, Passed, {}, -Any, Any},
        Member{"alpha_texture", &M::alpha_texture, Never, Passed},
        Member{"double_sided", &M::is_double_sided, Never}};
}();

inline bool MaterialMember::is_usual(const Material& material) const {
    static const Material Usual{};
    return std::visit([&](auto member) { return material.*member == Usual.*member; }, at);
}

inline bool MaterialMember::stands(const Material& material, const MemberRule& rule) const {
    for (const MaterialMember& other : MaterialMembers)
        if (other.name == rule.with)
            return !other.is_usual(material);
    return (rule.models >> static_cast<unsigned>(material.model) & 1u) != 0 ||
           (rule.if_unusual && !is_usual(material));
}

} // namespace relumine::mesh
