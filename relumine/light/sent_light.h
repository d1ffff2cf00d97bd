// The light that pictures of rooms gather by rays.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "relumine/in/scene.h"
#include "relumine/light/bounces.h"

namespace relumine {

/// Light that a picture may gather anew at the points that it shows
/// (relight/pictures/gathered_light.h). In a room most light has bounced.
struct SentLight {
    /// [num_receivers] radiance that surfaces send.
    std::vector<glm::vec3> sent = {};
    /// [num_receivers] what receivers have of the soft light of surfaces and sky, for albedo 1.
    std::vector<glm::vec3> replaced = {};
};

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
