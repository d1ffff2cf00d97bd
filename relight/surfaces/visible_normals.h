// Directions of a rough surface's facets, as an eye sees them.
//
// Based on: E. Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 7(4), 2018.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace relumine::relight {

/// Returns a half vector that an eye sees, in the frame of the normal [Heitz 2018, Listing 1].
[[nodiscard]] glm::vec3 visible_half(const glm::vec3& to_eye, float alpha, const glm::vec2& u);

/// Returns the density of directions that are mirrored at half vectors of visible_half():
/// D G1 / (4 n.v).
[[nodiscard]] float mirrored_density(const glm::vec3& half, float n_v, float alpha);

} // namespace relumine::relight
