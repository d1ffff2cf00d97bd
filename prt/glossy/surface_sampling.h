// Surfaces from a mesh's materials and textures.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <glm/vec2.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/glossy/surface.h"

namespace relumine::prt {

/// The surface of a triangle's point: position a + x (b - a) + y (c - a) for barycentric (x, y).
/// Lambert, albedo 1 where the mesh has no materials. Metallic-roughness: albedo = base (1 -
/// metallic), F0 = mix(0.04, base, metallic), GGX; Phong: Blinn-Phong where Ks > 0, Lambert
/// otherwise.
[[nodiscard]] Surface surface_at(const mesh::TriangleMesh& mesh, std::uint32_t triangle,
                                 const glm::vec2& barycentric);

/// Another surface for points of a triangle, given its own: materials from the command line.
using SurfaceOverride = std::function<Surface(const mesh::TriangleMesh& mesh,
                                              std::uint32_t triangle, const Surface& surface)>;

/// One surface per vertex: at its corner of the lowest triangle that uses it; Lambert, albedo 1 for
/// vertices without one.
[[nodiscard]] std::vector<Surface> vertex_surfaces(const mesh::TriangleMesh& mesh,
                                                   const SurfaceOverride& override_surface = {});

} // namespace relumine::prt
