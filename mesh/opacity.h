// What lets light pass: surfaces that alpha cuts out or thins.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Returns the uv at a triangle's point, given the weights of the second and third corner; 0
/// without uvs.
[[nodiscard]] glm::vec2 uv_at(const TriangleMesh& mesh, std::uint32_t triangle,
                              const glm::vec2& barycentric);

/// Whether some of the light that meets the material may go on behind it.
[[nodiscard]] bool lets_light_pass(const Material& material);

/// Whether any material of the mesh's triangles does.
[[nodiscard]] bool lets_light_pass(const TriangleMesh& mesh);

/// Whether pictures may see through a material's triangles: light passes, or backs are not shown.
[[nodiscard]] bool lets_eye_pass(const Material& material);

/// Returns the part of the light that stays at a point of a triangle, 0 to 1: its alpha, or, where
/// a material is cut out, 0 or 1.
[[nodiscard]] float opacity(const TriangleMesh& mesh, std::uint32_t triangle,
                            const glm::vec2& barycentric);

/// Returns a white material with the same alpha and sides.
[[nodiscard]] Material without_colors(const Material& material);

/// What rays of light need of a mesh: positions, triangles, and where light passes all that
/// opacity() reads. Materials and textures keep their numbers.
[[nodiscard]] TriangleMesh blockers_of(const TriangleMesh& mesh);

} // namespace relumine::mesh
