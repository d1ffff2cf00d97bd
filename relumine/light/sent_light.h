// The light that pictures of rooms gather by rays.
#pragma once

#include <span>

#include <glm/vec3.hpp>

#include "relumine/in/scene.h"
#include "relumine/light/bounces.h"
#include "relumine/light/lighting.h"

namespace relumine {

/// Sets Lighting::sent and Lighting::replaced of a room in which all bounces are there. `gathered`
/// is what receivers send of the light that is gathered, [num_receivers].
///
/// Cost:    O(receivers).
void add_sent_light(const Scene& scene, const SceneBounces& bounces,
                    std::span<const glm::vec3> gathered, Lighting& lighting);

/// Whether pictures gather the light of a scene's surfaces: of a room of vertices
/// (relight::inside_room()) without highlights that are stored for an eye.
///
/// Cost:    O(triangles).
[[nodiscard]] bool is_gathered(const Scene& scene);

} // namespace relumine
