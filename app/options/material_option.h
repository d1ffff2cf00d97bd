// Materials on the command line: ggx:roughness=0.3,albedo=0.5,0.4,0.3,f0=0.04 or
// blinn:exponent=50,kd=0.3,ks=0.2 or lambert:albedo=0.8; with GROUP= in front for one object of a
// file that has several.
#pragma once

#include <string>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "prt/glossy/surface_sampling.h"
#include "relumine/material.h"

namespace relumine::app {

/// Parses one option. Throws UsageError "expected X, got Y" that names `option`.
[[nodiscard]] SurfaceMaterial parse_material(const std::string& text,
                                             const std::string& option = "--material");

/// All options on a mesh, in their order: later ones win. Throws UsageError for a group
/// that the mesh does not have.
[[nodiscard]] prt::SurfaceOverride surface_override(const std::vector<SurfaceMaterial>& options,
                                                    const mesh::TriangleMesh& mesh,
                                                    const std::string& option = "--material");

} // namespace relumine::app
