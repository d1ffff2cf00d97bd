// Exact integration of arriving light, for any normal: every light of the environment, every shadow
// ray.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "files/parallel.h"
#include "prt/receivers/receivers.h"
#include "prt/visibility/blockers.h"
#include "relight/harmonics/harmonics.h"

namespace relumine::relight {

/// Calls visit(i, direction, power) for the light that reaches chosen receiver i, texel by texel.
template<class Visit>
void for_arriving(const prt::Receivers& receivers, std::span<const std::uint32_t> indices,
                  const prt::Blockers& blockers, const cubemap::CubeMap& environment, float bias,
                  const Visit& visit) {
    const std::uint32_t r = environment.resolution;
    const std::vector<double> solid_angles = cubemap::texel_solid_angles(r);
    files::parallel_for(std::size_t{0}, indices.size(), [&](std::size_t i) {
        const glm::vec3& normal = receivers.normals[indices[i]];
        const glm::vec3 origin = prt::ray_origin(receivers.positions[indices[i]], normal, bias);
        for (const cubemap::Face face : cubemap::AllFaces)
            for (std::uint32_t y = 0; y < r; ++y)
                for (std::uint32_t x0 = 0; x0 < r; x0 += prt::PacketSize) {
                    prt::DirectionPacket packet;
                    packet.num_directions = prt::PacketSize;
                    std::uint32_t active = 0;
                    for (std::uint32_t lane = 0; lane < prt::PacketSize; ++lane) {
                        const std::uint32_t x = std::min(x0 + lane, r - 1);
                        packet.set(lane, cubemap::texel_direction(face, x, y, r));
                        const bool is_lit = x0 + lane < r &&
                                            environment.at(face, x, y) != glm::vec3(0.0f) &&
                                            (indices[i] < receivers.num_points() ||
                                             prt::is_above(normal, packet.direction(lane)));
                        active |= std::uint32_t{is_lit} << lane;
                    }
                    if (active != 0)
                        active &= ~blockers.occluded(origin, packet, active);
                    for (; active != 0; active &= active - 1) {
                        const std::uint32_t x =
                            x0 + static_cast<std::uint32_t>(std::countr_zero(active));
                        visit(i, cubemap::texel_direction(face, x, y, r),
                              glm::dvec3(environment.at(face, x, y)) *
                                  solid_angles[std::size_t{y} * r + x]);
                    }
                }
    });
}

/// Returns the sums over all 6 R^2 texels of L_j dw_j V(w_j) Y(w_j) for chosen receivers, in
/// double: V is 0 below a surface's horizon. `bias` lifts the rays' origins.
///
/// Shape:   [receiver_indices.size()][order^2].
/// Cost:    a ray per receiver and texel that is not black; parallel over receivers.
inline std::vector<glm::dvec3> exact_harmonics(const prt::Receivers& receivers,
                                               std::span<const std::uint32_t> receiver_indices,
                                               const prt::Blockers& blockers,
                                               const cubemap::CubeMap& environment,
                                               std::uint32_t order, float bias) {
    const std::size_t count = num_harmonics(order);
    std::vector<glm::dvec3> sums(receiver_indices.size() * count);
    for_arriving(receivers, receiver_indices, blockers, environment, bias,
                 [&](std::size_t i, const glm::dvec3& direction, const glm::dvec3& power) {
                     const std::array<double, MaxHarmonics> values = harmonics(direction);
                     for (std::size_t k = 0; k < count; ++k)
                         sums[i * count + k] += values[k] * power;
                 });
    return sums;
}

/// Returns the irradiance of other normals at the chosen receivers: the light that arrives there,
/// above the receiver's own horizon, on a surface that is turned to normals[i].
///
/// Shape:   [receiver_indices.size()], as are the normals.
inline std::vector<glm::dvec3> exact_irradiance(const prt::Receivers& receivers,
                                                std::span<const std::uint32_t> receiver_indices,
                                                std::span<const glm::vec3> normals,
                                                const prt::Blockers& blockers,
                                                const cubemap::CubeMap& environment, float bias) {
    std::vector<glm::dvec3> sums(receiver_indices.size());
    for_arriving(receivers, receiver_indices, blockers, environment, bias,
                 [&](std::size_t i, const glm::dvec3& direction, const glm::dvec3& power) {
                     sums[i] += std::max(0.0, glm::dot(glm::dvec3(normals[i]), direction)) * power;
                 });
    return sums;
}

} // namespace relumine::relight
