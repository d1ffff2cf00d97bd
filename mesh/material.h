// Materials as mesh files have them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace relumine::mesh {

/// What lies outside the unit square of a texture.
enum class Wrap : std::uint8_t { Repeat, Clamp, Mirror };

/// A texture in use.
struct TextureSlot {
    /// Index into TriangleMesh::textures
    std::uint32_t texture = 0;
    /// Bytes are decoded to linear colour before they are filtered
    bool is_srgb = false;
    /// Along u, v
    std::array<Wrap, 2> wrap{};
    /// The place in the texture is this times the mesh's uv
    glm::mat2 uv_from_mesh_uv{1.0f};
    /// Plus this
    glm::vec2 uv_offset{0.0f};

    bool operator==(const TextureSlot&) const = default;
};

/// What the numbers of a material mean.
enum class MaterialModel : std::uint8_t {
    /// Kd, Ks, Ns of MTL: Lambert where Ks is 0, Blinn-Phong otherwise
    Phong,
    /// Of glTF 2.0, or of MTL with Pr or Pm
    MetallicRoughness,
};

/// One material. Colours are linear RGB.
struct Material {
    std::string name = {};
    MaterialModel model = MaterialModel::Phong;
    /// Phong: Kd; 0..1
    glm::vec3 base_color{1.0f};
    /// 0..1
    float metallic = 0.0f;
    /// 0..1
    float roughness = 1.0f;
    /// Phong: Ks, 0..1
    glm::vec3 specular{0.0f};
    /// Phong: Ns, >= 0
    float exponent = 0.0f;
    /// glTF: COLOR_0 is a factor of the base colour
    bool times_vertex_color = false;
    /// RGB, a factor of base_color
    std::optional<TextureSlot> base_color_texture = {};
    /// G, B: factors of roughness, metallic
    std::optional<TextureSlot> metallic_roughness_texture = {};

    bool operator==(const Material&) const = default;
};

} // namespace relumine::mesh
