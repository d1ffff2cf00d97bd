// Materials as mesh files define them.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace relumine::mesh {

class BrdfTable;

/// How a texture continues outside the unit square.
enum class Wrap : std::uint8_t { Repeat, Clamp, Mirror };

/// A texture and how a material uses it.
struct TextureSlot {
    /// Index into TriangleMesh::textures.
    std::uint32_t texture = 0;
    /// True: bytes are decoded to linear colour before they are filtered.
    bool is_srgb = false;
    /// For u and v.
    std::array<Wrap, 2> wrap{};
    /// 0: the place in the texture is from TriangleMesh::uvs, 1: from its second_uvs.
    std::uint32_t uv_set = 0;
    /// The place in the texture is uv_from_mesh_uv times the mesh's uv, plus uv_offset.
    glm::mat2 uv_from_mesh_uv{1.0f};
    glm::vec2 uv_offset{0.0f};

    bool operator==(const TextureSlot&) const = default;
};

/// The meaning of a material's numbers.
enum class MaterialModel : std::uint8_t {
    /// Kd, Ks and Ns of MTL: Lambert if Ks is 0, Blinn-Phong otherwise.
    Phong,
    /// The model of glTF 2.0, or of MTL with Pr or Pm.
    MetallicRoughness,
    /// KHR_materials_pbrSpecularGlossiness of glTF: GGX with a diffuse colour and F0.
    SpecularGlossiness,
    /// KHR_materials_unlit of glTF: the base colour is radiance, and light changes nothing.
    Unlit,
    /// A table: Material::measured. No file of a mesh has it; users give it.
    Measured,
};

/// What a material's alpha does (glTF's alphaMode).
enum class AlphaMode : std::uint8_t {
    /// Nothing.
    Opaque,
    /// Where it is below the cutoff, the surface does not exist: leaves, fences.
    Mask,
    /// It is the part of the light that the surface takes; the rest goes on behind it.
    Blend,
};

/// One material. Colours are linear RGB.
struct Material {
    std::string name = {};
    MaterialModel model = MaterialModel::Phong;
    /// In [0, 1]. Phong: Kd. SpecularGlossiness: the diffuse colour, of which F0 takes its part.
    glm::vec3 base_color{1.0f};
    /// In [0, 1].
    float metallic = 0.0f;
    /// In [0, 1].
    float roughness = 1.0f;
    /// In [0, 1]. Phong: Ks. SpecularGlossiness: F0.
    glm::vec3 specular{0.0f};
    /// Phong: Ns, >= 0.
    float exponent = 0.0f;
    /// True (glTF): COLOR_0 multiplies the base colour.
    bool times_vertex_color = false;
    /// Its RGB multiplies base_color.
    std::optional<TextureSlot> base_color_texture = {};
    /// Its G multiplies roughness, its B metallic.
    std::optional<TextureSlot> metallic_roughness_texture = {};
    /// MetallicRoughness, of MTL: their R multiply roughness and metallic.
    std::optional<TextureSlot> roughness_texture = {};
    std::optional<TextureSlot> metallic_texture = {};
    /// SpecularGlossiness, and Phong: its RGB multiplies specular.
    std::optional<TextureSlot> specular_texture = {};
    /// Radiance of its own, >= 0: glTF's factor times KHR_materials_emissive_strength.
    glm::vec3 emission{0.0f};
    /// Its RGB multiplies emission.
    std::optional<TextureSlot> emission_texture = {};
    AlphaMode alpha_mode = AlphaMode::Opaque;
    /// In [0, 1].
    float alpha = 1.0f;
    /// Mask: >= 0.
    float alpha_cutoff = 0.5f;
    /// Its R multiplies alpha. Only where alpha_mode is not Opaque.
    std::optional<TextureSlot> alpha_texture = {};
    /// The part of the light that meets the dielectric part of the surface and goes on through it,
    /// in [0, 1]: KHR_materials_transmission.
    float transmission = 0.0f;
    /// Its R multiplies transmission.
    std::optional<TextureSlot> transmission_texture = {};
    /// KHR_materials_volume: how thick the body behind the surface is, >= 0. 0: a thin sheet.
    float thickness = 0.0f;
    /// What is left of light on a way of attenuation_distance through the body.
    glm::vec3 attenuation_color{1.0f};
    float attenuation_distance = std::numeric_limits<float>::infinity();
    /// How far such a body parts colours, >= 0: 20 over Abbe's number, KHR_materials_dispersion.
    float dispersion = 0.0f;
    /// The part of the diffuse light that goes to the other side of the surface in place of being
    /// reflected, in [0, 1]: KHR_materials_diffuse_transmission.
    float diffuse_transmission = 0.0f;
    /// Its R multiplies diffuse_transmission.
    std::optional<TextureSlot> diffuse_transmission_texture = {};
    /// In [0, 1]. What the surface leaves of that part.
    glm::vec3 diffuse_transmission_color{1.0f};
    /// Its RGB multiplies diffuse_transmission_color.
    std::optional<TextureSlot> diffuse_transmission_color_texture = {};
    /// False: pictures do not show the backs. They block light all the same.
    bool is_double_sided = true;
    /// Normals in the frame of tangent, bitangent and normal, as 2 RGB - 1.
    std::optional<TextureSlot> normal_texture = {};
    /// Multiplies x and y of the texture's normals.
    float normal_scale = 1.0f;
    /// MetallicRoughness: the index of refraction, >= 1; 0: infinite. F0 of what is not metal.
    float ior = 1.5f;
    /// In [0, 1]. MetallicRoughness: multiplies all that a dielectric mirrors.
    float specular_strength = 1.0f;
    /// Its R multiplies specular_strength.
    std::optional<TextureSlot> specular_strength_texture = {};
    /// >= 0. MetallicRoughness: multiplies a dielectric's F0.
    glm::vec3 specular_tint{1.0f};
    /// Its RGB multiplies specular_tint.
    std::optional<TextureSlot> specular_tint_texture = {};
    /// In [0, 1]. MetallicRoughness: the part that a clear coat covers.
    float coat = 0.0f;
    /// Its R multiplies coat.
    std::optional<TextureSlot> coat_texture = {};
    /// In [0, 1].
    float coat_roughness = 0.0f;
    /// Its G multiplies coat_roughness.
    std::optional<TextureSlot> coat_roughness_texture = {};
    /// Normals of the coat alone (normal_texture). Without it the coat has the mesh's normals.
    std::optional<TextureSlot> coat_normal_texture = {};
    float coat_normal_scale = 1.0f;
    /// In [0, 1]. MetallicRoughness: the colour of fibres that stand out of a cloth.
    glm::vec3 sheen{0.0f};
    /// Its RGB multiplies sheen.
    std::optional<TextureSlot> sheen_texture = {};
    /// In [0, 1].
    float sheen_roughness = 0.0f;
    /// Its R multiplies sheen_roughness.
    std::optional<TextureSlot> sheen_roughness_texture = {};
    /// In [0, 1]. MetallicRoughness: the part that a thin film covers, KHR_materials_iridescence.
    float film = 0.0f;
    /// Its R multiplies film.
    std::optional<TextureSlot> film_texture = {};
    /// The film's index of refraction, >= 1.
    float film_ior = 1.3f;
    /// How thick the film is in nanometres, >= 0, where the texture's G is 0 and where it is 1.
    /// Without a texture it is as where G is 1.
    float film_thickness_at_0 = 100.0f;
    float film_thickness_at_1 = 400.0f;
    std::optional<TextureSlot> film_thickness_texture = {};
    /// In [0, 1]. MetallicRoughness: how far highlights are stretched, KHR_materials_anisotropy.
    float anisotropy = 0.0f;
    /// The direction along which they are, counter-clockwise from the tangent in radians.
    float anisotropy_rotation = 0.0f;
    /// Its R and G turn that direction: they are its cosine and sine, as 2 RG - 1. Its B multiplies
    /// anisotropy.
    std::optional<TextureSlot> anisotropy_texture = {};
    /// Measured: the table. `specular` multiplies it.
    std::shared_ptr<const BrdfTable> measured = {};

    bool operator==(const Material&) const = default;
};

/// Returns what stands for a material that cannot be read: grey, Lambert.
[[nodiscard]] inline Material unreadable_material(std::string name) {
    return {.name = std::move(name), .base_color = glm::vec3(0.5f)};
}

} // namespace relumine::mesh
