// Where the light of a precompute is received. Private.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "prt/visibility/ray_scene.h"
#include "relumine/in/precompute_options.h"
#include "relumine/in/scene.h"

namespace relumine {

/// Gives the scene the receivers that the options name, with their layout and the eye that sees
/// them. `rays`: of what blocks light. `prefix` begins messages. `lightmap_uvs`: those of Mesh.
/// Second uvs that nothing uses go.
///
/// Throws:  std::runtime_error for receivers that the mesh or a file cannot give.
void place_receivers(Scene& scene, const PrecomputeOptions& options, const PrecomputeWork& work,
                     const prt::RayScene& rays, const std::string& prefix,
                     std::optional<std::uint32_t> lightmap_uvs, PrecomputeReport& report);

} // namespace relumine
