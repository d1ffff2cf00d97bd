// Materials on the command line: ggx:roughness=0.3,albedo=0.5,0.4,0.3,f0=0.04 or
// blinn:exponent=50,kd=0.3,ks=0.2 or lambert:albedo=0.8; with GROUP= in front for one object of a
// file that has several.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/glossy/surface_sampling.h"

namespace relumine::app {

/// What one option says. Colours that it leaves out stay the file's.
struct MaterialOption {
    /// The group or material that the option is for. Empty: the whole mesh.
    std::string group = {};
    prt::Highlight highlight = prt::Highlight::None;
    float roughness_or_exponent = 1.0f;
    /// `albedo` or `kd`
    std::optional<glm::vec3> albedo = {};
    /// `f0` or `ks`; without it 0.04 where the file has no F0 of its own
    std::optional<glm::vec3> specular = {};

    /// The surface in place of the file's.
    [[nodiscard]] prt::Surface applied_to(const prt::Surface& surface) const;
};

/// Parses one option. Throws UsageError "expected X, got Y" that names `option`.
[[nodiscard]] MaterialOption parse_material(const std::string& text,
                                            const std::string& option = "--material");

/// All options on a mesh, in their order: later ones win. Throws UsageError for a group
/// that the mesh does not have.
[[nodiscard]] prt::SurfaceOverride surface_override(const std::vector<MaterialOption>& options,
                                                    const mesh::TriangleMesh& mesh,
                                                    const std::string& option = "--material");

} // namespace relumine::app
