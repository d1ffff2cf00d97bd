// Surfaces from a mesh's materials and textures.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include <glm/vec2.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/receivers/mesh_point.h"
#include "prt/receivers/surface.h"

namespace relumine::prt {

struct TextureView;

/// How GGX of materials is evaluated: Highlight::GgxWhole, or Highlight::Ggx, glTF's formula as it
/// is published.
enum class GgxForm { Whole, Published };

/// Returns the surface at a triangle's point, position a + x (b - a) + y (c - a) for barycentric
/// (x, y).
///
/// Textures are means over what a sample of the view sees; without a view, values at the point.
/// Lambert of albedo 1 where the mesh has no materials. Metallic-roughness materials give GGX with
/// albedo = base (1 - metallic) and F0 = mix(0.04, base, metallic), specular-glossiness materials
/// GGX with albedo = base, or base (1 - max F0) as published. A dielectric's own F0 takes the place
/// of 0.04. The normal of a clear coat is the receiver's. Phong materials give Blinn-Phong
/// where Ks > 0, Lambert otherwise. Measured materials have their table. Unlit materials are black
/// and emit their colour.
[[nodiscard]] Surface surface_at(const mesh::TriangleMesh& mesh, std::uint32_t triangle,
                                 const glm::vec2& barycentric, GgxForm form = GgxForm::Whole,
                                 const TextureView* view = nullptr);

/// Returns F0 of a surface that is no metal: of KHR_materials_ior and _specular. An ior of 0 stands
/// for an infinite one.
[[nodiscard]] glm::vec3 dielectric_f0(float ior, float strength, const glm::vec3& tint);

/// Returns what surface_at() gives as emission, at less cost; none for unlit materials, which give
/// no light.
[[nodiscard]] glm::vec3 emission_at(const mesh::TriangleMesh& mesh, std::uint32_t triangle,
                                    const glm::vec2& barycentric);

/// Returns the part of the light of a surface's other side that it passes on diffusely.
[[nodiscard]] glm::vec3 passed_on_at(const mesh::TriangleMesh& mesh, const MeshPoint& at,
                                     const TextureView* view = nullptr);
/// Whether a triangle's material passes any on.
[[nodiscard]] bool passes_light_on(const mesh::TriangleMesh& mesh, std::uint32_t triangle);
/// Whether any material of the mesh does.
[[nodiscard]] bool passes_light_on(const mesh::TriangleMesh& mesh);

/// Returns the surface of a measured BRDF.
[[nodiscard]] Surface measured_surface(std::shared_ptr<const mesh::BrdfTable> table);

/// Whether light changes what a triangle shows: not that of unlit ones, and of those of alpha 0.
[[nodiscard]] bool shows_light(const mesh::TriangleMesh& mesh, std::size_t triangle);

/// Whether surfaces of a material have a highlight.
[[nodiscard]] bool has_highlight(const mesh::Material& material);

/// Returns a material of this surface without its emission: plain where it has no highlight, whose
/// colour is that of the vertices.
[[nodiscard]] mesh::Material material_of(const Surface& surface);

/// Returns the surface for a scene without a view, where highlights are left out: of one as
/// published. What a metal reflects, F0 above the 0.04 of other surfaces, counts as diffuse:
/// otherwise metals were black. So does what sheen reflects towards 60 degrees.
[[nodiscard]] Surface without_highlight(Surface surface);

/// Widens the highlights of a surface whose unit normals differ from their mean by this mean square
/// over what it stands for, those of its coat by another: a narrower lobe would sparkle there.
/// Tables stay as they are.
///
/// Based on: Y. Tokuyoshi, A. Kaplanyan, "Improved Geometric Specular Antialiasing", I3D 2019 (the
///           variance of slopes adds to alpha^2; here a fifth of it, by where nine tenths lie).
void widen(Surface& surface, float normal_spread, float of_coat);

/// Replaces the surface of a triangle's points, given its own: materials from the command line.
using SurfaceOverride = std::function<Surface(const mesh::TriangleMesh& mesh,
                                              std::uint32_t triangle, const Surface& surface)>;

/// Returns one surface per vertex, taken at its corner of the lowest triangle that uses it. A
/// vertex without a triangle gets Lambert of albedo 1.
[[nodiscard]] std::vector<Surface> vertex_surfaces(const mesh::TriangleMesh& mesh,
                                                   const SurfaceOverride& override_surface = {},
                                                   GgxForm form = GgxForm::Whole);

} // namespace relumine::prt
