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
    std::uint32_t texture = 0;       ///< index into TriangleMesh::textures
    bool is_srgb = false;            ///< bytes are decoded to linear colour before they are filtered
    std::array<Wrap, 2> wrap{};      ///< along u, v
    glm::mat2 uv_from_mesh_uv{1.0f}; ///< the place in the texture is this times the mesh's uv
    glm::vec2 uv_offset{0.0f};       ///< plus this

    bool operator==(const TextureSlot&) const = default;
};

/// What the numbers of a material mean.
enum class MaterialModel : std::uint8_t {
    Phong,             ///< Kd, Ks, Ns of MTL: Lambert where Ks is 0, Blinn-Phong otherwise
    MetallicRoughness, ///< of glTF 2.0, or of MTL with Pr or Pm
};

/// One material. Colours are linear RGB.
struct Material {
    std::string name = {};
    MaterialModel model = MaterialModel::Phong;
    glm::vec3 base_color{1.0f};                         ///< Phong: Kd; 0..1
    float metallic = 0.0f;                              ///< 0..1
    float roughness = 1.0f;                             ///< 0..1
    glm::vec3 specular{0.0f};                           ///< Phong: Ks, 0..1
    float exponent = 0.0f;                              ///< Phong: Ns, >= 0
    bool times_vertex_color = false;                    ///< glTF: COLOR_0 is a factor of the base colour
    std::optional<TextureSlot> base_color_texture = {}; ///< RGB, a factor of base_color
    std::optional<TextureSlot> metallic_roughness_texture = {}; ///< G, B: factors of roughness, metallic

    bool operator==(const Material&) const = default;
};

} // namespace relumine::mesh
