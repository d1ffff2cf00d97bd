// Exact integration of arriving light, for any normal: every light of the environment, every shadow
// ray.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "prt/receivers/receivers.h"
#include "prt/visibility/blockers.h"

namespace relumine::relight {

/// Returns the sums over all 6 R^2 texels of L_j dw_j V(w_j) Y(w_j) for chosen receivers, in
/// double: V is 0 below a surface's horizon. `bias` lifts the rays' origins.
///
/// Shape:   [receiver_indices.size()][order^2].
/// Cost:    a ray per receiver and texel that is not black; parallel over receivers.
[[nodiscard]] std::vector<glm::dvec3>
exact_harmonics(const prt::Receivers& receivers, std::span<const std::uint32_t> receiver_indices,
                const prt::Blockers& blockers, const cubemap::CubeMap& environment,
                std::uint32_t order, float bias);

/// Returns the irradiance of other normals at the chosen receivers: the light that arrives there,
/// above the receiver's own horizon, on a surface that is turned to normals[i].
///
/// Shape:   [receiver_indices.size()], as are the normals.
[[nodiscard]] std::vector<glm::dvec3>
exact_irradiance(const prt::Receivers& receivers, std::span<const std::uint32_t> receiver_indices,
                 std::span<const glm::vec3> normals, const prt::Blockers& blockers,
                 const cubemap::CubeMap& environment, float bias);

} // namespace relumine::relight
