// What lets light pass: surfaces that alpha cuts out or thins, and glass.
#pragma once

#include <cstdint>
#include <span>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Returns the uv of a set at a triangle's point, given the weights of the second and third corner;
/// 0 without uvs.
[[nodiscard]] glm::vec2 uv_at(const TriangleMesh& mesh, std::uint32_t triangle,
                              const glm::vec2& barycentric, std::uint32_t uv_set);

/// What a surface leaves of the light behind it.
struct Veil {
    /// The factor on the surface's own light
    float weight = 1.0f;
    /// The factor on the light of what is behind the surface
    glm::vec3 through{0.0f};
    bool operator==(const Veil&) const = default;
};

/// Whether some of the light that meets the material may go on behind it.
[[nodiscard]] bool lets_light_pass(const Material& material);

/// Whether any material of the mesh's triangles does.
[[nodiscard]] bool lets_light_pass(const TriangleMesh& mesh);

/// Whether a material is there and yet seen through: blended, or glass.
[[nodiscard]] bool is_thin(const Material& material);

/// Whether pictures may see through a material's triangles: light passes, or backs are not shown.
[[nodiscard]] bool lets_eye_pass(const Material& material);

/// Returns the veil that a point of a triangle is: all or nothing of what alpha cuts out, alpha's
/// part of what it blends, and the tint of glass. Light goes straight on. Each surface of glass
/// keeps what a flat one of index 1.5 reflects. A thin sheet takes the base colour's part; the two
/// surfaces of a body share the base colour and what the way through the body takes.
[[nodiscard]] Veil veil(const TriangleMesh& mesh, std::uint32_t triangle,
                        const glm::vec2& barycentric);

/// Returns by what a surface of glass multiplies the light that goes on through it and is not
/// mirrored: its transmission, and of its base colour what veil() takes. The way through a body
/// takes more.
[[nodiscard]] glm::vec3 glass_tint(const TriangleMesh& mesh, std::uint32_t triangle,
                                   const glm::vec2& barycentric);

/// Returns the veil where all textures of a material are looked up at one place of theirs.
[[nodiscard]] Veil veil(const Material& material, std::span<const Texture> textures,
                        const glm::vec2& place);

/// Returns the material with the alpha, glass and sides of another.
[[nodiscard]] Material passed_as(Material material, const Material& other);

/// Returns a white material with the same alpha, glass and sides.
[[nodiscard]] Material without_colors(const Material& material);

/// What rays of light need of a mesh: positions, triangles with their groups, and where light
/// passes all that veil() reads. Materials and textures keep their numbers.
[[nodiscard]] TriangleMesh blockers_of(const TriangleMesh& mesh);

} // namespace relumine::mesh
