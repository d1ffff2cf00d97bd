// Distant lights traced one by one: a shadow ray for each light and receiver.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "lights/light_list.h"
#include "prt/visibility/blockers.h"

namespace relumine::relight {

/// What tracing of single lights needs. Without blockers no light is traced.
struct ShadowRays {
    /// Must outlive its user; null: nothing is traced.
    const prt::Blockers* blockers = nullptr;
    /// [num_receivers] in the receivers' own order; must outlive its user.
    std::span<const glm::vec3> positions = {};
    /// Lift of the rays' origins, as in prt::PrecomputeOptions.
    float bias = 0.0f;
    /// Tolerance of the precompute, RMS form, 1/sr.
    float tolerance = 0.0135f;
};

/// Returns the outgoing radiance for albedo 1 of the chosen receivers under the lights: 1/pi sum of
/// E_i V(w_i) max(n.w_i, 0). `rays.positions` are the receivers' own.
///
/// Shape:   [receiver_indices.size()].
/// Throws:  std::invalid_argument for shadow rays without blockers or with another number of
///          positions, and for an index out of range.
/// Cost:    O(receivers x lights) shadow rays.
/// Threads: parallel; the order of each sum is fixed.
[[nodiscard]] std::vector<glm::dvec3>
radiance_under(std::span<const lights::DistantLight> lights, std::span<const glm::vec3> normals,
               std::span<const std::uint32_t> receiver_indices, const ShadowRays& rays);

/// Returns the outgoing radiance for albedo 1 of all receivers, [normals.size()].
[[nodiscard]] std::vector<glm::vec3> radiance_under(std::span<const lights::DistantLight> lights,
                                                    std::span<const glm::vec3> normals,
                                                    const ShadowRays& rays);

} // namespace relumine::relight
