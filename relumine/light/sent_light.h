// The light that pictures of rooms gather by rays.
#pragma once

#include <span>

#include <glm/vec3.hpp>

#include "relumine/in/scene.h"
#include "relumine/light/bounces.h"
#include "relumine/light/lighting.h"

namespace relumine {

/// Returns the light of a room in which all bounces are there, given what receivers send,
/// [num_receivers]: of all light, and of what is gathered.
///
/// Cost:    O(receivers).
[[nodiscard]] SentLight sent_light(const Scene& scene, const SceneBounces& bounces,
                                   std::span<const glm::vec3> radiance,
                                   std::span<const glm::vec3> gathered);

/// Whether pictures gather the light of a scene's surfaces: of a room of vertices
/// (relight::inside_room()) without highlights that are stored for an eye.
///
/// Cost:    O(triangles).
[[nodiscard]] bool is_gathered(const Scene& scene);

} // namespace relumine
