// Surfaces in place of a mesh's materials, for the whole mesh or for one of its groups.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/glossy/surface_sampling.h"
#include "prt/receivers/surface.h"

namespace relumine {

/// A material. Colours that it leaves out stay the mesh's.
struct SurfaceMaterial {
    /// The group of the mesh that it is for. Empty: the whole mesh.
    std::string group = {};
    prt::Highlight highlight = prt::Highlight::None;
    /// Roughness of GGX, exponent of Blinn-Phong (prt::Surface::roughness_or_exponent).
    float roughness_or_exponent = 1.0f;
    /// Diffuse reflectance.
    std::optional<glm::vec3> albedo = {};
    /// F0, or Ks of Blinn-Phong. Without it 0.04 where the mesh has no F0 of its own.
    std::optional<glm::vec3> specular = {};
    /// Measured: the table, and the file that it is of.
    std::shared_ptr<const mesh::BrdfTable> table = {};
    std::string file = {};

    /// Returns the surface in place of the mesh's.
    [[nodiscard]] prt::Surface applied_to(const prt::Surface& surface) const;
};

/// Returns all materials on a mesh, for PrecomputeOptions::surface. Later ones win.
///
/// Throws:  std::invalid_argument for a group that the mesh does not have.
[[nodiscard]] prt::SurfaceOverride surface_override(std::span<const SurfaceMaterial> materials,
                                                    const mesh::TriangleMesh& mesh);

} // namespace relumine
